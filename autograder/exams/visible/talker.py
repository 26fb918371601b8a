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

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Scenario
from autograder.judging.causes.ended import close_name, why_no_endpoint, why_no_node, why_silent
from autograder.judging.checks import require_messages, require_qos, SECOND
from autograder.judging.rhythm import require_period
from autograder.recording import Event
from autograder.results import shortened

TYPE = 'std_msgs/msg/String'
ABSOLUTE = '/chatter'
PERIOD_S = 0.5
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
    """Return the messages that count, in order."""
    return [event for event in run.recording.messages(heard_on(run)) if 'data' in event]


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
    """It publishes twice a second."""
    found = run.recording.messages(heard_on(run))
    # A program that takes some seconds to begin is watched for so many less.
    begins_s = found[0]['clock_ns'] / SECOND if found else 0.0
    late_s = max(0, int(begins_s - 2 * PERIOD_S))
    require_period(run, found, PERIOD_S, run.facts['seconds'] - late_s)


def counts_its_greetings(run: Run) -> None:
    """The texts are hello 1, hello 2 and so on, one more each time."""
    found, least = greetings(run), int(run.facts['seconds']) // 2
    if len(found) < least:
        raise Failed(
            expected=f'at least {least} messages, to see how it counts',
            observed=f'{len(found)}',
            why=why_silent(run)
            or Cause('wrong_rate', 'Too few messages come.', 'Fix the rate first.'),
        )
    texts = [str(event['data']['data']) for event in found]
    # A greeting that was sent before anybody could be connected is lost, and counts.
    first = found[0]['number']
    for number, text in enumerate(texts, first):
        if text != f'hello {number}':
            raise Failed(
                expected=f'the text {f"hello {number}"!r} in message {number}',
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
    if int(match[1]) == number - 1:
        return Cause('counts_from_zero', 'The count begins with 0.', 'Add 1 before you publish.')
    return Cause(
        'begins_later',
        f'Message {number} of your node is greeting {match[1]}: the count does not begin with 1, '
        'or something counts and does not publish.',
        'Begin with self.count = 0, and let the timer alone call the method that counts and '
        'publishes.',
    )


def offers_reliable_qos(run: Run) -> None:
    """Its quality of service is reliable and volatile, as depth 10 gives."""
    ends = run.recording.endpoints('publisher', heard_on(run))
    require_qos(ends, reliability='RELIABLE', durability='VOLATILE')


def build(space: str, seconds: float) -> Exam:
    """
    Return the exam in one namespace.

    :param space: where the node is started, such as ``/lab``
    :param seconds: for how long it is heard [s]
    """
    exam = Exam(
        'talker',
        title='The talker',
        assignment='03_topics',
        part=1,
        scenario=Scenario(
            file='talker.py',
            arguments=('-r', f'__ns:={space}'),
            watch={f'{space}/chatter': TYPE, ABSOLUTE: TYPE},
            steps=(Advance(seconds),),
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


exam = build('/lab', seconds=6.0)
