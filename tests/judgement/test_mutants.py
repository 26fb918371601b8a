"""Mutants of the references are found, and the tables match real runs."""

from collections import Counter

import pytest

from autograder.judging.judge import worth_running
from tests.judgement import agreement, causes, mutants, stored_results
from tests.judgement.derive import all_mutants, mutants_of, written
from tests.judgement.references import exercises


def chosen():
    """
    Return one mutant per exam that needs no build, of as many kinds as possible.

    ``make judgement`` runs all mutants, and ``make check`` says whether to repeat it.
    """
    found = []
    for number, exercise in enumerate(exercises()):
        cheap = [
            one
            for one in mutants_of(exercise)
            if exercise.exam.scenario.program != 'build'
            or not worth_running(exercise.exam, one.files)
        ]
        found.append((exercise.exam, cheap[number * len(cheap) // len(exercises())]))
    return found


def test_mutants_are_many_and_differ():
    """There are at least a hundred mutants, some in every exam, with unique names and contents."""
    found = all_mutants()
    programs = [one for one in found if not any(path.startswith('answers/') for path in one.files)]
    contents = Counter(tuple(sorted(one.files.items())) for one in found)

    assert len(programs) >= 100
    assert {one.exam for one in found} == {one.name for one in exercises()}
    assert len({(one.exam, one.name) for one in found}) == len(found)
    assert set(contents.values()) == {1}


def test_every_exam_finds_nearly_all_and_survivors_are_explained():
    """The test reads the stored results of every exam."""
    results = stored_results.load(mutants.NAME)

    assert set(results) == {one.name for one in exercises()}
    assert mutants.mistakes(results) == []
    assert all(one['because'] for one in (*written()['survivors'], *written()['leave']))


def test_every_cause_is_proven():
    """A submission, a mutant or a unit test proves each cause in the code."""
    assert causes.unproven() == []


def test_mistakes_of_beginners_are_recognised():
    """At least forty mistakes are recognised, not counting wrong letters in the quiz."""
    named = {name for one in causes.in_the_code() for name in causes.proven(one.cause_id)}

    assert len([name for name in named if not causes.QUESTION.match(name)]) >= causes.LEAST


def test_the_tables_claim_no_disagreement():
    """The verdicts and causes of the project's samples are as expected."""
    results = stored_results.load(agreement.NAME)

    assert set(results) == {one.name for one in exercises()}
    assert [line for one in results.values() for line in one['differences']] == []


@pytest.mark.pipeline
@pytest.mark.slow
@pytest.mark.ros
@pytest.mark.timeout(1200)
def test_a_spread_of_mutants_meets_the_verdicts_of_the_table():
    """A real run gives the same check and the same cause as docs/mutants.md."""
    results = stored_results.load(mutants.NAME)
    work = chosen()
    wanted = {(exam.name, one.name): results[exam.name]['found'][one.name] for exam, one in work}

    done = stored_results.run_all([(exam, one.files) for exam, one in work])
    got = {
        (exam.name, one.name): mutants.verdict(result) for (exam, one), result in zip(work, done)
    }

    assert got == wanted
