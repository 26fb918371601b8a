"""Mistakes in an exam are refused with their place before a class is graded."""

from pathlib import Path
import re

from collect_sources import laid
import pytest

from autograder.authoring.exam_mistakes import (
    differs_from_visible,
    lesson_headings,
    read_mistakes,
    self_check,
    unsendable,
)
from autograder.errors import ExamInvalid
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.exam.specification import each, Specification
from autograder.exam.steps import Advance, Call, Feed, Join, Leave, Mark, Offer, Watch
from autograder.judging.claims import (
    answers,
    beats,
    declares,
    hears,
    one_for_one,
    publishes,
    serves,
)
from autograder.layout import Layout

STRING, SET = 'std_msgs/msg/String', 'rcl_interfaces/srv/SetParameters'


def exam(**scenario) -> Exam:
    facts = {'file': 'a.py', **scenario}
    return Exam(
        'sample',
        title='T',
        assignment='01_x',
        part=1,
        cells=('a',),
        requires=('a.py',),
        scenario=Scenario(**facts),
    )


def feed(topic, *messages, **facts):
    return Feed(topic, messages or [{'data': 'x'}], **facts)


class TestWhenItIsMade:
    """Mistakes that the scenario alone reveals."""

    @pytest.mark.parametrize(
        ('scenario', 'said'),
        [
            (
                {'feed': {'/chatter': STRING}, 'steps': (Advance(1), feed('/chater'))},
                "exam sample, step 2 (Feed): '/chater' was not announced by Scenario(feed=...), "
                "an Offer or a Join; announced: '/chatter'; did you mean '/chatter'?",
            ),
            ({'steps': (feed('/chatter'),)}, "step 1 (Feed): '/chatter' was not announced"),
            (
                {'steps': (Offer('one', '/t', STRING), Leave('one'), feed('one'))},
                "step 3 (Feed): 'one' was not announced",
            ),
            ({'steps': (Leave('late'),)}, "step 1 (Leave): 'late' was not announced"),
            (
                {'steps': (Watch('/a'),)},
                "step 1 (Watch) '/a': expected a topic of Scenario(watch=...)",
            ),
            (
                {'feed': {'/t': STRING}, 'steps': (feed('/t', *[{}] * 11, burst=True),)},
                'step 1 (Feed): expected at most 10 messages per burst, got 11',
            ),
            ({'steps': (Advance(0),)}, 'step 1 (Advance): the number of seconds'),
            (
                {'watch': {'/t': 'std_msgs/String'}},
                "watch '/t': expected a type such as std_msgs/msg/String, got 'std_msgs/String'",
            ),
            ({'feed': {'/t': 'std_msgs.msg.String'}}, "feed '/t': expected a type such as"),
            ({'watch': {'t': STRING}}, "watch 't': expected a full topic name"),
            (
                {'steps': (Call('/a', 'get_state', 'lifecycle_msgs/msg/State'),)},
                'step 1 (Call)',
            ),
        ],
    )
    def test_a_contradiction_is_refused_with_its_place(self, scenario, said):
        with pytest.raises(ExamInvalid) as refused:
            exam(**scenario)

        assert said in str(refused.value)

    def test_what_comes_and_goes_in_order_is_fine(self):
        steps = (
            Offer('one', '/t', STRING),
            feed('one'),
            Leave('one'),
            Join('late', '/t', STRING),
            Leave('late'),
        )

        assert exam(steps=steps).scenario.steps == steps


class TestWithRos:
    """Mistakes that show only with an installed ROS: the probe's code tries to send the values."""

    @pytest.mark.parametrize(
        ('scenario', 'said'),
        [
            (
                {'watch': {'/t': 'std_msg/msg/String'}},
                "exam sample, watch '/t': std_msg/msg/String is not installed: No module named",
            ),
            (
                {'feed': {'/t': 'std_msgs/msg/Strin'}},
                "exam sample, feed '/t': std_msgs/msg/Strin is not installed: ",
            ),
            (
                {'steps': (Join('late', '/t', 'toys/msg/Toy'),)},
                "exam sample, step 1 (Join) 'late': toys/msg/Toy is not installed: ",
            ),
            (
                {'feed': {'/t': STRING}, 'steps': (feed('/t', {'data': ''}, {'dta': ''}),)},
                'exam sample, step 1 (Feed): message 2: std_msgs/msg/String cannot hold this: ',
            ),
        ],
    )
    def test_a_type_or_field_that_is_not_there_is_named(self, scenario, said):
        (line,) = unsendable([exam(**scenario)])

        assert line.startswith(said)
        assert 'environment/messages.txt' in line

    def test_values_that_their_fields_cannot_hold_are_named(self):
        wrong = [
            ('std_msgs/msg/Bool', {'data': 'yes'}, "'data'"),
            ('std_msgs/msg/Bool', {'data': 1}, "'data'"),
            ('std_msgs/msg/Int32', {'data': 1.0}, "'data'"),
            ('std_msgs/msg/Int32', {'data': 2**31}, "'data'"),
            ('std_msgs/msg/UInt8', {'data': -1}, "'data'"),
            ('std_msgs/msg/Float64', {'data': 'warm'}, 'warm'),
            ('std_msgs/msg/Float64', {'data': None}, 'NoneType'),
            ('std_msgs/msg/Float32', {'data': 1e39}, "'data'"),
            (STRING, {'data': 5}, "'data'"),
            ('std_msgs/msg/Byte', {'data': b'1'}, "'data'"),
            ('temp_monitor_pkg/msg/Temperature', {'timestamp': 2.5}, 'float'),
            ('temp_monitor_pkg/msg/Temperature', {'timestamp': {'nanosecs': 0}}, 'nanosecs'),
            ('temp_monitor_pkg/msg/Temperature', {'timestamp': {'nanosec': -1}}, "'nanosec'"),
            ('unique_identifier_msgs/msg/UUID', {'uuid': [0] * 15}, "'uuid'"),
            ('rcl_interfaces/msg/ParameterDescriptor', {'integer_range': [{}, {}]}, "'integer_r"),
            ('std_msgs/msg/Int32MultiArray', {'layout': {'dim': [{'size': -1}]}}, "'size'"),
            ('std_msgs/msg/Int32MultiArray', {'data': 'abc'}, "'data'"),
            ('std_msgs/msg/Empty', {'data': 1}, "'data'"),
        ]

        exams = [
            exam(feed={'/t': kind}, steps=(Advance(1), feed('/t', {}, message)))
            for kind, message, _ in wrong
        ]

        lines = unsendable(exams)
        for line, (kind, _, said) in zip(lines, wrong):
            where = 'exam sample, step 2 (Feed): message 2'
            assert line.startswith(f'{where}: {kind} cannot hold this: ')
            assert said in line
        assert len(lines) == len(wrong)

    def test_a_request_is_tried_too(self):
        kind = 'rcl_interfaces/srv/SetParameters'
        wanted = {'parameters': [{'name': 'a', 'value': {'type': 2, 'integer_value': 'two'}}]}
        wrong = exam(steps=(Call('/a', 'set_parameters', kind, wanted),))

        (line,) = unsendable([wrong])

        assert line.startswith("exam sample, step 1 (Call) 'set_parameters': rcl_interfaces/srv/")
        assert "'integer_value'" in line

    def test_what_can_be_sent_is_fine(self):
        """The value of a float may be a string, as in JSON, and constants are not fields."""
        fine = [
            ('std_msgs/msg/Float64', {'data': 'nan'}),
            ('std_msgs/msg/Float32', {'data': float('inf')}),
            ('std_msgs/msg/Float32', {'data': 3}),
            ('std_msgs/msg/Int64', {'data': -(2**63)}),
            ('std_msgs/msg/Char', {'data': 65}),
            ('std_msgs/msg/UInt8MultiArray', {'data': (0, 255)}),
            ('unique_identifier_msgs/msg/UUID', {'uuid': list(range(16))}),
            ('rcl_interfaces/msg/ParameterDescriptor', {'integer_range': [{'step': 2}]}),
            ('std_msgs/msg/Header', {'stamp': {'sec': -1}, 'frame_id': ''}),
            ('std_msgs/msg/Empty', {}),
            ('temp_monitor_pkg/msg/Num', {'num': 1}),
        ]
        call = Call('/a', 'get_state', 'lifecycle_msgs/srv/GetState')

        exams = [exam(feed={'/t': kind}, steps=(feed('/t', one), call)) for kind, one in fine]

        assert unsendable(exams) == []


HEADINGS = {'01_x': {'Part 1: Doors', 'Summary'}, '02_y': {'Part 2: Timers'}}


class TestWithTheLessons:
    """The lesson sections that checks tell learners to read."""

    @staticmethod
    def reads(section='', own=''):
        """Return an exam with one check; the exam and the check may name a section to read."""
        made = exam()
        made.read = section

        def opens(run):
            """It opens."""

        made.check(points=1, read=own)(opens)
        return made

    @pytest.mark.parametrize(
        ('section', 'own', 'said'),
        [
            ('', '', 'expected a section to read, got none'),
            (
                'Part 1: Dors',
                '',
                "heading of 01_x to read, got 'Part 1: Dors'; did you mean 'Part",
            ),
            ('Part 1: Doors', 'Part 2: Timers', "of 01_x to read, got 'Part 2: Timers'"),
            (
                'lesson 02, Part 1: Doors',
                '',
                "expected a heading of 02_y to read, got 'Part 1: Do",
            ),
            ('lesson 03, Part 1: Doors', '', 'there is no lesson 03'),
            ('lesson 02, ', '', "expected a heading of 01_x to read, got 'lesson 02, '"),
        ],
    )
    def test_a_section_that_no_lesson_has_is_refused(self, section, own, said):
        """The section of a check takes precedence over that of the exam."""
        (line,) = read_mistakes(self.reads(section, own), HEADINGS)

        assert line.startswith('exam sample, check opens: ')
        assert said in line

    @pytest.mark.parametrize(
        ('section', 'own'),
        [
            ('Part 1: Doors', ''),
            ('', 'Summary'),
            ('Summary', 'lesson 02, Part 2: Timers'),
            ('lesson 02, on clocks', ''),
        ],
    )
    def test_a_heading_is_fine(self, section, own):
        assert list(read_mistakes(self.reads(section, own), HEADINGS)) == []

    def test_without_the_lesson_only_an_empty_section_is_refused(self):
        """If the lesson is missing, its headings are unknown."""
        assert list(read_mistakes(self.reads('Part 7'), {})) == []
        assert len(list(read_mistakes(self.reads(), {}))) == 1

    def test_headings_are_those_of_the_released_lessons(self, tmp_path: Path):
        cells = '{"cells": [{"cell_type": "markdown", "source": ["# A\\n", "## B"]}]}'
        laid(tmp_path, {'01_x/a.ipynb': cells.encode(), '02_y/a.ipynb': b'{}'})

        assert lesson_headings(tmp_path) == {'01_x': {'A', 'B'}}


class TestBeforeItIsUsed:
    """Differences between the two versions of an exam, and mistakes that the self-check finds."""

    def test_the_graded_exam_is_the_visible_one_with_other_inputs(self):
        """With different cells, the two exams would judge different answers."""
        graded, visible = exam(), exam()
        graded.cells = ('b',)

        (line,) = differs_from_visible(graded, visible)

        assert "expected the same cells as in the visible exam, ('a',), got ('b',)" in line

    def test_self_check_refuses_an_exam_before_it_runs_it(self, tmp_path: Path, monkeypatch):
        """An exam with a mistake is not run, because the probe would seem to be at fault."""
        from autograder.authoring import exam_mistakes as module

        wrong = exam(watch={'/t': 'std_msgs/msg/Strin'})
        lesson = module.Lesson('01_x', 'x.ipynb', {'cells': []}, (wrong,))
        monkeypatch.setattr(catalog, 'load', lambda *_, **__: wrong)
        monkeypatch.setattr(module, 'load_lesson', lambda *_: lesson)
        laid(tmp_path, {'notebooks/01_x/x.ipynb': b'{}'})

        ((right, line),) = self_check(Layout(tmp_path), None)

        assert not right
        assert line.startswith(
            "01_x: exam sample, watch '/t': std_msgs/msg/Strin is not installed"
        )


DOUBLES = Specification([1, 2], each(lambda one: (2 * one,)))
WRONG_CLAIMS = [
    (hears('/in', STRING), "a topic on which a Feed publishes ('/ask'), got '/in'"),
    (
        publishes('doubles', '/anser'),
        "a topic that the scenario watches ('/answer'), got '/anser'",
    ),
    (publishes('double', '/answer'), "a specification of Exam(asks=...) ('doubles'"),
    (
        one_for_one('many', '/answer'),
        "'many' has 3 inputs, more than the messages in the scenario (2)",
    ),
    (
        answers('calls', '/a/set'),
        "'calls' has 2 inputs, more than the calls of /a/set in the scenario (1)",
    ),
    (serves('/a/set', 'std_srvs/srv/SetBool'), "the type of /a/set in the scenario ('rcl_interf"),
    (serves('/a/set', SET), 'a service of the exercise, got one that each node has'),
    (beats('/answer', 2.0, 'on'), "the phase 'on' lasts 4 s; expected at least 6 s"),
    (
        one_for_one('bare', '/answer'),
        "a tuple with a value per message as each answer of 'bare', got",
    ),
    (answers('doubles', '/a/set'), "expected a dict as each answer of 'doubles', got (2,)"),
    (
        serves('/set', 'std_srvs/srv/SetBool'),
        "a service that the scenario calls ('/a/set'), got '/set'",
    ),
    (beats('/answer', 1.0, 'off'), "a phase that begins with a Mark ('on'), got 'off'"),
    (declares('/a', {'rate': 2.0}), "expected the step Call(node='/a', service='get_parameters'"),
]
"""Claims that the exam of the test cannot answer, with the reason."""


@pytest.mark.parametrize(('judge', 'said'), WRONG_CLAIMS)
def test_claim_that_the_exam_cannot_answer_is_refused(judge, said):
    """Otherwise a correct program would fail."""
    asks = {
        'doubles': DOUBLES,
        'many': Specification([1, 2, 3], DOUBLES.due),
        'calls': Specification([1, 2], each(lambda one: {'data': one})),
        'bare': Specification([1, 2], each(lambda one: one)),
    }
    steps = (Mark('on'), feed('/ask', {'data': '1'}, {'data': '2'}), Call('/a', 'set', SET))
    made = exam(feed={'/ask': STRING}, watch={'/answer': STRING}, steps=steps)
    made.asks = asks

    with pytest.raises(ExamInvalid, match=re.escape(said)):
        made.check(points=1)(judge)
