"""
Hostile programs get what their honest part deserves, and nothing leaves the sandbox.

The docstring of each says what it tries and deserves, see :mod:`tests.attacks.corpus`.  All
programs run once, in parallel; a separate test then checks each property.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
import os
from pathlib import Path
import time

import pytest

from autograder.classroom.pages import write_all_reports
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.sandboxes.choose import strongest
from tests.attacks.corpus import Attack, CANARY, early_limits, grade, Outcome, programs

# All programs run within the first test's time limit; on two processors, they take four minutes.
pytestmark = [pytest.mark.attacks, pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(1200)]

ATTACKS = programs()
SLEEPER = b'86397'
LOOT = ('FOUND', 'WROTE', 'ESCAPED', 'REACHED')
"""Words that a program prints when its attack succeeds."""
WORKERS = 3
LONGEST_S = 60.0
"""Maximum real time of a run, which may use four seconds of CPU time while others compete."""
WAITING_S = 15.0
"""The same for a run that ends because nothing computes, after 0.3 or 2.5 s."""


def names(attack: Attack) -> str:
    return f'{attack.kind}-{attack.name}'


@pytest.fixture(scope='session')
def graded(tmp_path_factory):
    """Run every attack, and return the outcomes."""
    kept = tmp_path_factory.mktemp('recordings')
    # Put a secret into the grader's environment and into an open file; the attacks search for it.
    secret = tmp_path_factory.mktemp('hidden') / 'gradebook.json'
    secret.write_text(f'{{"{CANARY}": 1}}', encoding='utf-8')
    os.environ['COURSE_SECRET_CANARY'] = CANARY
    sandbox = strongest()

    def run(attack: Attack) -> Outcome:
        began = time.monotonic()
        try:
            outcome = grade(attack, sandbox, kept)
        except GraderError as error:  # keep the other outcomes
            outcome = Outcome(None, None, str(error))
        return replace(outcome, took_s=time.monotonic() - began)

    with secret.open() as file, early_limits(), ThreadPoolExecutor(WORKERS) as pool:
        os.set_inheritable(file.fileno(), True)
        outcomes = dict(zip(ATTACKS, pool.map(run, ATTACKS)))
    return outcomes


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_attack_gains_nothing(graded, attack):
    outcome = graded[attack]

    assert outcome.result is not None, outcome.fault
    if attack.at_most:
        assert outcome.result.points <= attack.points
    else:
        assert outcome.result.points == attack.points


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_attack_ends_in_time_and_as_it_is_stated(graded, attack):
    """No run takes longer than the limit, and each ends for the stated reason."""
    outcome = graded[attack]

    assert outcome.took_s < (WAITING_S if attack.ends == 'waits_outside' else LONGEST_S)
    if attack.ends:
        assert outcome.recording.end_reason == attack.ends


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_attack_finds_and_reaches_nothing(graded, attack):
    """The program emits no secret, and does not report that it reached something."""
    outcome = graded[attack]

    if outcome.recording is not None:
        text = outcome.recording.to_bytes().decode()
        assert CANARY not in text
        for printed in (str(one.process.get('stdout', '')) for one in outcome.recording.starts):
            assert not any(word in printed for word in LOOT)


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_attack_that_names_a_flag_is_flagged(graded, attack):
    outcome = graded[attack]
    assert outcome.result is not None, outcome.fault
    seen = outcome.result.flags

    for flag in attack.flags:
        assert any(flag in one for one in seen), seen


def test_no_process_is_left_behind(graded):
    left = []
    for folder in Path('/proc').glob('[0-9]*'):
        try:
            if SLEEPER in (folder / 'cmdline').read_bytes():
                left.append(folder.name)
        except OSError:
            continue

    assert left == []


def test_report_of_all_attacks_is_harmless(graded, tmp_path):
    results = [
        SubmissionResult(attack.name, attack.kind, (outcome.result,), fault=outcome.fault)
        for attack in ATTACKS
        if (outcome := graded[attack]).result
    ]
    write_all_reports(Layout(tmp_path), '07_temperature_monitor', results)
    pages = ''.join(file.read_text(encoding='utf-8') for file in tmp_path.rglob('*.html'))

    assert '&lt;script&gt;' in pages
    assert '<script' not in pages
    assert '\x1b' not in pages
    assert CANARY not in pages
