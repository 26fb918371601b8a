"""
No feedback on a hidden exam reveals the inputs that the exam has drawn.

The tests do not run a program, but imitate one: it makes a mistake in each step of the exam's
scenario and repeats its inputs.  Every check judges it, without waiting for other checks.
"""

from collections.abc import Iterator
import copy
from dataclasses import dataclass, replace
import json
from typing import Any

import pytest

from autograder.exam import catalog
from autograder.exam.exam import Exam, Run
from autograder.exam.steps import Advance, Call, Feed, Join, Look, Mark, Offer
from autograder.explaining.picture_data import pictures
from autograder.judging.causes.redaction import namespace_of, redacted, safe_quotation
from autograder.judging.judge import judge
from autograder.recording import ERROR, INFO, Recording, WARN
from autograder.results import CheckResult, Verdict
from tests.judgement.drawn_inputs import NAMES, revealed_values, sent_by, texts_of

NODES = {
    'harbour': ('harbour/lookout', 'harbour/keeper'),
    'managed_beacon': ('beacon',),
    'managed_pressure': ('pressure_monitor',),
}
CODE = 'class Mine(Node):\n    create_timer, create_subscription\n    self.publisher.publish(m)\n'
RELIABLE = {'reliability': 'RELIABLE', 'durability': 'VOLATILE', 'liveliness': 'AUTOMATIC'}
RELIABLE |= dict.fromkeys(['deadline_ns', 'lifespan_ns'])
LATCHED = {**RELIABLE, 'durability': 'TRANSIENT_LOCAL'}
BEGINS_NS, TICK_S = 550_000_000, 0.25
SENT = {'event': 'input', 'index': 0}
ANSWERS = {
    'change_state': {'success': True},
    'get_state': {'current_state': {'label': 'unconfigured'}},
    'get_parameters': {'values': []},
    'set_parameters': {'results': [{'successful': True, 'reason': ''}]},
    'set_parameters_atomically': {'result': {'successful': False, 'reason': 'no'}},
}


@dataclass(frozen=True)
class Program:
    """
    The mistakes of a program.

    :param place: prefix of the program's node and topic names, in which {} is the namespace
    :param node_slip: suffix of the program's node names
    :param topic_slip: suffix of the program's topic names
    :param ends: whether the program has publishers and subscriptions
    :param type: type of all endpoints; empty for the correct types
    :param says: template of the string that it logs and publishes for an input, or None
    :param died: whether an exception that contains all inputs ends the program
    """

    place: str = '{}'
    node_slip: str = ''
    topic_slip: str = ''
    nodes: bool = True
    ends: bool = True
    type: str = ''
    qos: Any = None
    says: str | None = None
    level: int = INFO
    died: bool = False


PROGRAMS = {
    'dies at once': Program(nodes=False, died=True),
    'never makes a node': Program(nodes=False),
    'has another name': Program(node_slip='er'),
    'leaves its namespace': Program(place='', says='{} in {space}'),
    'makes a namespace': Program(place='/mine{}', says='{space}: {}'),
    'creates nothing': Program(ends=False),
    'has other topics': Program(topic_slip='s'),
    'has other types': Program(type='std_msgs/msg/Bool'),
    'asks for and offers little': Program(qos={**RELIABLE, 'reliability': 'BEST_EFFORT'}),
    'keeps and asks for old messages': Program(qos=LATCHED, says='{}'),
    'is mute': Program(),
    'dies of an input': Program(says='{}', died=True),
    'repeats': Program(says='{}'),
    'repeats in other words': Program(says='I have heard {} in {space}, at last', level=WARN),
    'repeats as an error': Program(says='{}?', level=ERROR),
    'rounds': Program(says='{:.1f}'),
    'shouts': Program(says='{!r:>12}', level=WARN),
}


class Played:
    """The recording of a program that follows a scenario in its own way."""

    def __init__(self, exam: Exam, program: Program) -> None:
        self.exam, self.program = exam, program
        self.space = namespace_of(exam.scenario)
        names = NODES.get(exam.name, (exam.name,)) if program.nodes else ()
        place = program.place.format(self.space)
        self.nodes = [f'{place}/{name}{program.node_slip}' for name in names]
        self.clock_ns = BEGINS_NS
        self.index: int | None = None
        self.heard: Any = 0
        self.sent = 0
        self.listeners: list[str | None] = [None]
        self.events: list[dict[str, Any]] = []
        self.play()

    def play(self) -> None:
        """Record the events that the probe would have observed."""
        self.graph('start')
        for step in self.exam.scenario.steps if self.nodes else ():
            self.follow(step)
        for node in self.nodes:
            self.note('asked', node=node, answered=True)
        self.graph('end')
        self.note('end', reason='complete' if self.nodes else 'student_exited')
        inputs = sent_by(self.exam) if self.nodes else ()
        heard = ' '.join(map(str, [self.space, *inputs]))
        died = f'Traceback (most recent call last):\nValueError: {heard}\n'
        code = {'exit': 1, 'stderr': died} if self.program.died else {'exit': None, 'stderr': ''}
        self.note('process', killed='', stdout='', **code)

    def note(self, event: str, **facts: Any) -> None:
        moment = {'clock_ns': self.clock_ns, 'after_input': self.index}
        self.events.append({'event': event, **moment, **facts})

    def graph(self, when: str) -> None:
        ends = list(self.ends()) if self.program.ends else []
        self.note('graph', when=when, nodes=self.nodes, endpoints=ends)

    def ends(self) -> Iterator[dict[str, Any]]:
        """Yield the required endpoints, with the program's mistakes."""
        scenario, program = self.exam.scenario, self.program
        for node in self.nodes:
            for kind, topic, type_name in scenario.endpoints():
                where = program.place.format(self.space) + topic.removeprefix(self.space)
                yield {
                    'kind': kind,
                    'topic': where + program.topic_slip,
                    'node': node,
                    'type': program.type or type_name,
                    'type_hash': '',
                    'process': 0,
                    'qos': program.qos or RELIABLE,
                }

    def follow(self, step: Any) -> None:
        """Take one step of the scenario."""
        if isinstance(step, Advance):
            for _ in range(round(step.seconds / TICK_S)):
                self.wait(TICK_S)
                self.say()
        elif isinstance(step, Feed):
            for message in step.messages:
                self.index = 0 if self.index is None else self.index + 1
                self.note('input', index=self.index, topic=step.topic, data=dict(message))
                for self.heard in message.values():
                    if not isinstance(self.heard, (dict, list)):
                        self.say()
                self.wait(0.0 if step.burst else step.every_s)
            self.wait(step.rest_s)
        elif isinstance(step, Call):
            answer = ANSWERS[step.service.rpartition('/')[2]]
            facts = {'service': step.name, 'request': step.request, 'data': answer}
            self.note('answer', **json.loads(json.dumps(facts)))
        elif isinstance(step, Mark):
            self.note('mark', name=step.name)
        elif isinstance(step, Look):
            self.graph(step.when)
        elif isinstance(step, Join):
            self.listeners.append(step.name)
            self.note('joined', listener=step.name, matched=True, refused=[])
            self.say()
        elif isinstance(step, Offer):
            self.note('offered', publisher=step.name, matched=True, refused=[])

    def wait(self, seconds: float) -> None:
        self.clock_ns += round(seconds * 1e9)

    def say(self) -> None:
        """Log and publish the last input, always with the same stamp."""
        if self.program.says is None:
            return
        try:
            text = self.program.says.format(self.heard, space=self.space)
        except (TypeError, ValueError):  # a string or a dict cannot be rounded
            text = str(self.heard).upper()
        number = self.heard if isinstance(self.heard, (int, float)) else 1.0
        for node in self.nodes:
            logger = node.strip('/').replace('/', '.')
            self.note('log', name=logger, level=self.program.level, text=text)
        clock = self.exam.scenario.ros_clock
        stamp_ns = clock.at(BEGINS_NS) if clock else BEGINS_NS
        sec, nanosec = divmod(stamp_ns, 1_000_000_000)
        data = {
            'data': number if 'Float64' in str(self.exam.scenario.watch) else text,
            'temperature_value': float(number),
            'unit': text,
            'timestamp': {'sec': sec, 'nanosec': nanosec},
            'sensor_id': text,
        }
        topics = [*self.exam.scenario.watch]
        topics += [one.topic for one in self.exam.scenario.steps if isinstance(one, Join)]
        self.sent += 1
        facts = {'number': self.sent, 'data': data}
        for topic in dict.fromkeys(topics):
            if not topic.endswith('transition_event'):
                for listener in self.listeners:
                    self.note('message', topic=topic, listener=listener, **facts)


def alone(exam: Exam) -> Exam:
    """Return an exam whose checks do not wait for other checks."""
    one = copy.copy(exam)
    one.checks = [replace(check, needs=()) for check in exam.checks]
    return one


def starts_of(exam: Exam) -> Iterator[Exam]:
    """Yield an exam for each start of its program."""
    for start in exam.scenario.starts:
        one = copy.copy(exam)
        one.scenario = start
        yield one


def runs_of(exam: Exam) -> Iterator[tuple[str, Run]]:
    """Yield the run of each program that an exam judges."""
    files = dict.fromkeys(exam.requires, CODE)
    for name, program in PROGRAMS.items():
        first, *later = (Recording({}, Played(one, program).events) for one in starts_of(exam))
        recording = replace(first, again=next(iter(later), None))
        yield name, Run(files, recording, exam.facts)


def failures(exam: Exam) -> Iterator[tuple[str, Run, CheckResult]]:
    """Yield the failed checks of an exam, for each program."""
    for name, run in runs_of(exam):
        for check in judge(alone(exam), run):
            if check.verdict is Verdict.FAILED:
                yield name, run, check


each_exam = pytest.mark.parametrize('name', NAMES)


@each_exam
def test_no_text_about_a_hidden_exam_tells_what_was_drawn(name):
    exam = catalog.load(name)
    found = list(failures(exam))
    revealed = [
        (program, check.check, secret, texts_of(check))
        for program, _, check in found
        for secret in revealed_values(exam, texts_of(check))
    ]

    assert revealed == []
    assert {check.check for _, _, check in found} == {check.name for check in exam.checks}


@each_exam
def test_no_picture_of_a_hidden_exam_shows_its_namespace(name):
    """Pictures contain topic names too."""
    exam = catalog.load(name)
    spaces = [namespace_of(one).strip('/') for one in exam.scenario.starts]

    for _, run in runs_of(exam):
        shown = json.dumps(pictures(alone(exam), run, judge(alone(exam), run)))
        assert not any(space and space in shown for space in spaces)


@pytest.mark.parametrize(
    'name',
    [
        'managed_beacon',
        'map_server',
        'milli_reader',
        'night_watch',
        'running_mean',
        'sensor_watch',
        'talker',
        'temperature_publisher',
        'temperature_subscriber',
    ],
)
def test_the_same_texts_are_concrete_where_the_inputs_are_public(name):
    """Feedback on visible exams shows values, so the search in the test above is effective."""
    exam = alone(catalog.load(name))
    exam.hidden, exam.facts = False, {**exam.facts, 'secret': False}

    assert any(revealed_values(exam, texts_of(check)) for _, _, check in failures(exam))


@each_exam
def test_a_namespace_is_long_enough_to_be_left_out_of_texts(name):
    """A shorter namespace could be part of a word."""
    for start in catalog.load(name).scenario.starts:
        space = namespace_of(start).strip('/')
        assert not space or (len(space) >= 6 and not set(space) & set('aeiou'))


class TestWords:
    @pytest.mark.parametrize(
        ('exam', 'program', 'check', 'words'),
        [
            (
                *('night_watch', 'has another name', 'starts_in_the_namespace'),
                'a node called night_watch in the namespace that we chose\n'
                'Your program has a node called night_watcher, but none called night_watch.',
            ),
            (
                *('talker', 'keeps and asks for old messages', 'offers_reliable_qos'),
                'The publisher on chatter has the durability TRANSIENT_LOCAL instead of VOLATILE.',
            ),
            (
                *('map_server', 'repeats in other words', 'publishes_each_survey'),
                'a map for each survey, in the same order\n'
                'A published map is not the text of a survey.',
            ),
            ('sensor_watch', 'is mute', 'logs_each_distance', 'the number of distance 1'),
            ('temperature_publisher', 'repeats', 'stamps_follow_the_clock', 'an earlier stamp'),
        ],
    )
    def test_feedback_speaks_of_kinds_and_relations(self, exam, program, check, words):
        texts = [
            texts_of(one)
            for name, _, one in failures(catalog.load(exam))
            if (name, one.check) == (program, check)
        ]

        assert all(part in texts[0] for part in words.splitlines())

    @pytest.mark.parametrize(
        ('facts', 'events', 'code', 'shown'),
        [
            ({}, [SENT], '', "'a map'"),
            ({'secret': True}, [], '', "'a map'"),
            ({'secret': True}, [SENT], "data='a map'", "'a map'"),
            ({'secret': True}, [SENT], '', 'another text'),
        ],
        ids=['public', 'nothing sent', 'in the code', 'perhaps an echo'],
    )
    def test_own_words_are_quoted_unless_they_may_be_an_echo(self, facts, events, code, shown):
        run = Run({'a.py': code}, Recording({}, events), facts)

        assert safe_quotation(run, 'a map', 'another text') == shown

    def test_numbers_of_a_quoted_line_are_left_out(self):
        assert redacted(Run({}, Recording({}, ()), {}), '16.2 m') == '16.2 m'
        assert redacted(Run({}, Recording({}, ()), {'secret': True}), '16.2 m') == '… m'
