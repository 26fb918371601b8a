"""
Lesson 03, part 2: the talker.

The specification, as the lesson gives it: node ``talker``; a ``std_msgs/msg/String`` twice a
second on the relative topic ``chatter``; texts ``hello 1``, ``hello 2`` and so on; quality of
service reliable and volatile, which is what depth 10 gives.  The node is started in a namespace.
Both ``chatter`` in the namespace and an absolute ``/chatter`` are heard, so that an absolute name
costs its own points and not those of the other checks.
"""

from __future__ import annotations

import re

from autograder.judging.causes import close_name, why_no_endpoint, why_no_node, why_silent
from autograder.judging.checks import (
    refuse_own_clock,
    require_messages,
    require_period,
    require_qos,
)
from autograder.judging.exam import Cause, Exam, Failed, Run
from autograder.judging.own_time import names_another_clock
from autograder.judging.results import shortened
from autograder.runs.recording import Event
from autograder.runs.scenario import Advance, Scenario

TYPE = 'std_msgs/msg/String'
ABSOLUTE = '/chatter'
PERIOD_S, STEP_S = 0.5, 0.125
GREETING = re.compile(r'hello (\d{1,9})')
EXERCISE = 'Exercise 1: a talker that can move'


def relative(run: Run) -> str:
    """Return the full name of the topic where it should be."""
    return f'{run.facts["space"]}/chatter'


def heard_on(run: Run) -> str:
    """Return the topic that the rest is judged by: the right one, or else the absolute one."""
    right = relative(run)
    return right if run.recording.endpoints('publisher', right) else ABSOLUTE


def greetings(run: Run) -> list[Event]:
    """
    Return the messages that count, in order.

    Simulated time begins when both sides are connected, so what was sent before may be lost.
    """
    return [
        event
        for event in run.recording.messages(heard_on(run))
        if 'data' in event and event['clock_ns'] is not None
    ]


def starts_its_node(run: Run) -> None:
    """Your program starts a node called talker, in the namespace it was given."""
    if f'{run.facts["space"]}/talker' in run.recording.nodes:
        return
    # Without the namespace, which nobody is to know.
    names = sorted({name.rpartition('/')[2] for name in run.recording.nodes})
    if 'talker' in names:
        why = Cause(
            'own_namespace',
            'Your node chooses a namespace itself, or changes the one it was given.',
            "Call super().__init__('talker') without a namespace.",
        )
    elif names:
        why = Cause(
            'node_name',
            f'There is a node called {names[0][:60]}.',
            "Give super().__init__() the name 'talker'.",
        )
    else:
        why = why_no_node(run, '/talker')
    raise Failed(
        expected='a node called talker, in the namespace in which it was started',
        observed=', '.join(name[:60] for name in names[:5]) or 'no node',
        why=why,
    )


def publishes_greetings(run: Run) -> None:
    """It publishes String messages on chatter."""
    ends = run.recording.endpoints('publisher', heard_on(run))
    if not any(end['type'] == TYPE for end in ends):
        raise Failed(
            expected=f'a publisher of type {TYPE} on chatter',
            observed='no such publisher',
            why=_why_no_publisher(run),
        )
    require_messages(run, greetings(run), 1, 'messages on chatter')


def _why_no_publisher(run: Run) -> Cause | None:
    if run.recording.endpoints('publisher', heard_on(run)):
        return why_no_endpoint(run, 'publisher', heard_on(run), TYPE)
    ends = [end for end in run.recording.endpoints('publisher') if end['type'] == TYPE]
    if any(end['topic'].endswith('/talker/chatter') for end in ends):
        return Cause(
            'private_name',
            'With ~/ the topic belongs to the node alone: its name contains that of the node.',
            "Give create_publisher() the plain name 'chatter'.",
        )
    for end in ends:
        base = end['topic'].rpartition('/')[2]
        if base != 'chatter' and close_name('chatter', [base]):
            return Cause(
                'topic_name',
                f'Your publisher uses the topic {base}; did you mean chatter?',
                "Give create_publisher() the name 'chatter'.",
            )
    if any(end['topic'].endswith('/chatter') for end in ends):
        return Cause(
            'namespace_in_the_name',
            'The name of your topic contains a namespace; the node has one already.',
            "Give create_publisher() the plain name 'chatter'.",
        )
    return why_no_endpoint(run, 'publisher', heard_on(run), TYPE) if not ends else None


def moves_with_its_namespace(run: Run) -> None:
    """Its topic is relative: it moves along with the namespace of the node."""
    if heard_on(run) == relative(run):
        return
    raise Failed(
        expected='the topic chatter in the namespace in which the node was started',
        observed=f'the topic {ABSOLUTE}, in no namespace',
        why=Cause(
            'absolute_name',
            'A name that begins with a slash is absolute: it ignores the namespace.',
            "Write 'chatter', without the slash.",
        ),
    )


def speaks_twice_a_second(run: Run) -> None:
    """It publishes twice a second, measured on the ROS clock."""
    refuse_own_clock(run, 'two messages a second of the ROS clock')
    code = '\n'.join(run.files.values())
    # A loop that sleeps and serves the node in between answers now and then.
    sleeps = run.recording.end_reason == 'unresponsive' and 'create_timer' not in code
    if run.recording.in_wall_time or (sleeps and names_another_clock(run.files)):
        raise Failed(
            expected='two messages a second of the ROS clock',
            observed='messages that do not follow the ROS clock',
            why=Cause(
                'own_loop',
                'Your program keeps its own time, in a loop, and its node has no timer that '
                'follows the ROS clock.',
                'Use self.create_timer(0.5, ...) and rclpy.spin(node) instead of a loop.',
            ),
        )
    found = greetings(run)
    if len(found) < 3 and not why_silent(run):
        raise Failed(
            expected='two messages a second of the ROS clock',
            observed=f'{len(found)} in {run.facts["seconds"]:g} s',
            why=Cause(
                'wrong_rate',
                'The period of the timer is much too long.',
                'The first argument of create_timer() is the period in seconds: 0.5.',
            ),
        )
    require_period(run, found, PERIOD_S, run.facts['seconds'], STEP_S)


def counts_its_greetings(run: Run) -> None:
    """The texts are hello 1, hello 2 and so on, one more each time."""
    found, least = greetings(run), int(run.facts['seconds']) // 2
    if len(found) < least:
        raise Failed(
            expected=f'at least {least} messages, to see how it counts',
            observed=f'{len(found)}',
            why=why_silent(run)
            or Cause('wrong_rate', 'The messages come too rarely.', 'Mend their rate first.'),
        )
    texts = [str(event['data']['data']) for event in found]
    # Code that keeps its own time may have spoken before it could be heard.
    match = GREETING.fullmatch(texts[0])
    first = int(match[1]) if match and run.recording.in_wall_time else 1
    for number, text in enumerate(texts, start=first):
        if text != f'hello {number}':
            raise Failed(
                expected=f'the text {f"hello {number}"!r} in message {number - first + 1}',
                observed=repr(shortened(text)),
                why=_why_text(texts, text, number, first),
            )


def _why_text(texts: list[str], text: str, number: int, first: int) -> Cause | None:
    match = GREETING.fullmatch(text)
    if '{' in text and '}' in text:
        return Cause(
            'no_f_string',
            'The text has braces in it: they are filled in only if an f stands before the quotes.',
            "Publish String(data=f'hello {self.count}').",
        )
    if match is None:
        if GREETING.search(text.lower()):
            slip = 'Upper and lower case, spaces and punctuation count.'
            return Cause('wrong_text', slip, "Publish String(data=f'hello {self.count}').")
        return Cause('wrong_text', 'The text has another form.', 'Compare with the table.')
    if len(set(texts)) == 1:
        return Cause(
            'never_counts',
            'The number never changes.',
            'Keep it in self.count, made once in __init__(), and add 1 in the callback.',
        )
    if number != first:
        return Cause(
            'wrong_step',
            'From one message to the next the number does not grow by 1.',
            'Add 1 in the callback, once: self.count += 1.',
        )
    if match[1] == '0':
        return Cause('counts_from_zero', 'The count begins with 0.', 'Add 1 before you publish.')
    return Cause(
        'begins_later',
        f'The first greeting that can be heard is number {match[1]}: what was published before '
        'anybody was connected is lost, or something counts before the timer does.',
        'Let the timer alone call the method that counts and publishes.',
    )


def offers_reliable_qos(run: Run) -> None:
    """Its quality of service is reliable and volatile, as depth 10 gives."""
    ends = run.recording.endpoints('publisher', heard_on(run))
    require_qos(ends, reliability='RELIABLE', durability='VOLATILE')


def build(space: str, seconds: float, phase_s: float) -> Exam:
    """
    Return the exam in one namespace.

    :param space: where the node is started, such as ``/lab``
    :param seconds: simulated seconds
    :param phase_s: first clock value, 0 < phase_s < 0.125 [s]
    """
    exam = Exam(
        'talker',
        title='The talker',
        assignment='03_topics',
        part=1,
        cells=('talker',),
        requires=('talker.py',),
        scenario=Scenario(
            file='talker.py',
            arguments=('-r', f'__ns:={space}'),
            watch={f'{space}/chatter': TYPE, ABSOLUTE: TYPE},
            steps=(Advance(seconds, step_s=STEP_S, phase_s=phase_s),),
        ),
        read='Part 2: Names',
        facts={'space': space, 'seconds': seconds},
    )
    exam.check(points=1)(starts_its_node)
    exam.check(points=2, read='Part 1: Speaking and listening')(publishes_greetings)
    for points, judge, read in (
        (3, moves_with_its_namespace, ''),
        (2, speaks_twice_a_second, 'lesson 02, When a timer ticks'),
        (1, counts_its_greetings, EXERCISE),
        (1, offers_reliable_qos, 'lesson 05, Part 1: A profile'),
    ):
        exam.check(points=points, needs=['publishes_greetings'], read=read)(judge)
    return exam


exam = build('/lab', seconds=5.0, phase_s=0.05)
