"""
Explain programs that ended, nodes that do not answer, refused transitions, missing endpoints.

The program's own output may reveal a cause, but never affects a verdict.  If there is no evidence,
the functions return None: a misleading cause is worse than none.
"""

from collections.abc import Iterable
from dataclasses import replace
import difflib
import re
from typing import Any

from autograder.exam.exam import Cause, Run
from autograder.exam.specification import Specification
from autograder.judging.causes.builds import why_no_program
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.text_table import cause_of, rows_of, why_by_code
from autograder.judging.causes.tracebacks import traceback_of
from autograder.judging.causes.unknown_names import homes
from autograder.recording import Recording
from autograder.submission.code.acts import place_of
from autograder.submission.code.mistakes import pause_in_callback
from autograder.submission.code.source_code import Code

_NO_VERDICT = re.compile(r"'(\w{1,40})' object has no attribute 'to_label'")
_REFUSED_TRANSITION = 'Failed to trigger lifecycle state machine transition'

TRANSITIONS = {
    *('on_configure', 'on_activate', 'on_deactivate'),
    *('on_cleanup', 'on_shutdown', 'on_error'),
}
"""Methods of a lifecycle node that rclpy calls."""

_THREAD = 'Exception in thread '
"""Start of Python's message about an exception that ended a thread."""
_MOST_THREADS = 20  # maximum number of threads that are examined
_SPINS = re.compile(r'^ +File .*, in _?spin\w*$', re.MULTILINE)

LONG_S = 50.0
"""A period longer than in any exercise: the student probably meant milliseconds [s]."""

LIMITS = {'|'.join((row.cause_id, *row.more)): row for row in rows_of('by_limit.txt')}


def why_it_ended(run: Run) -> Cause | None:
    """Explain why a program ended early, None if it ran until the end."""
    recording = run.recording
    killed = str(recording.process.get('killed', '')) or recording.end_reason
    if killed in LIMITS:
        return why_killed(killed, 'package' if run.facts.get('package') else 'program')
    if cause := why_no_program(run) or why_no_verdict(run):
        return cause
    code = recording.process.get('exit')
    if code is None or ended_after_refusal(run):
        return None
    if (trace := traceback_of(run)) is not None:
        return exception_cause(trace)
    if code:
        return why_by_code('died' if recording.nodes else 'died_unseen', run, code=code)
    if sent := recording.of('input'):
        return why_by_code('mid_run', run, count=len(sent))
    # The start graph is recorded 0.5 s after the node was seen, so a program in this graph ran
    # longer than a single spin_once().
    seen = recording.of('graph', when='start')
    return why_by_code('over_later' if seen else 'over', run)


def why_killed(limit: str, what: str) -> Cause:
    """
    Explain why the grader stopped a program that exceeded a limit.

    :param what: ``program``, ``package`` or ``build``, whose limits differ
    """
    row = LIMITS.get(f'{limit}|{what}', LIMITS[limit])
    subject = 'build' if what == 'build' else 'program'
    text = f'The grader stopped your {subject}: {row.text}.'
    return Cause(limit, text, f'Look for {row.try_this}.')


def ended_after_refusal(run: Run) -> bool:
    """
    Return whether the program ended because it requested a transition that its state forbids.

    Such an end follows from an earlier refusal and is not a cause.
    """
    return _REFUSED_TRANSITION in str(run.recording.process.get('stderr', ''))


def close_name(wanted: str, names: Iterable[str]) -> str:
    """Return the name that is most similar to the wanted one, empty if none is similar enough."""
    found = difflib.get_close_matches(wanted, sorted(set(names)), n=1, cutoff=0.6)
    return found[0] if found else ''


def why_no_node(run: Run, wanted: str) -> Cause:
    """Explain why the probe did not see a node, given its full name."""
    others = [name for name in run.recording.nodes if name != wanted]
    near = close_name(wanted, others) or (others[0] if others else '')
    if near:
        return cause_of('node_name', near=near[1:], wanted=wanted.rpartition('/')[2])
    return why_it_ended(run) or why_thread_ended(run) or why_by_code('unseen', run)


def why_no_endpoint(run: Run, kind: str, topic: str, type_name: str) -> Cause:
    """
    Explain why the probe saw no endpoint with the right topic and type.

    :param kind: ``'publisher'``, ``'subscription'`` or ``'service'``
    """
    recording = run.recording
    base, wanted = topic.rpartition('/')[2], type_name.rpartition('/')[2]
    for end in recording.endpoints(kind, topic):
        if end['type'] != type_name:
            return cause_of('wrong_type', kind=kind, topic=topic, seen=end['type'], wanted=wanted)
    private = kind == 'service' and topic.count('/') > 1  # such as /lamp/switch of the node lamp
    if not private and (why := _why_longer_name(run, kind, topic, type_name)):
        return why
    # An endpoint on another topic of the exam is not this endpoint with a misspelt name.
    right = run.names.of_kind(kind)
    ends = [end for end in recording.endpoints(kind) if end['topic'] not in right]
    near = close_name(topic, (end['topic'] for end in ends))
    other = {'publisher': 'subscription', 'subscription': 'publisher'}.get(kind, '')
    if other and not near and recording.endpoints(other, topic):
        return cause_of('wrong_direction', kind=kind, topic=topic, other=other)
    same_type = (end['topic'] for end in ends if end['type'] == type_name)
    near = near or next(same_type, '')
    if near and topic.endswith(near) and not private:
        space = topic.removesuffix(near)
        return cause_of('absolute_name', kind=kind, near=near, space=space, base=near[1:])
    if near:
        # The code should write the name without the namespace of the node.
        spaces = [name.rpartition('/')[0] + '/' for name in recording.nodes]
        space = max((one for one in spaces if topic.startswith(one)), default='/')
        written = f'~/{base}' if private else topic.removeprefix(space)
        noun = 'name' if kind == 'service' else 'topic'
        words: dict[str, Any] = {'near': near, 'topic': topic, 'wanted': written}
        return cause_of('topic_name', kind=kind, noun=noun, **words)
    if ended := why_it_ended(run):
        return ended
    if not recording.nodes:
        return why_no_node(run, '/?')
    code = Code(run.files)
    managed = kind == 'publisher' and 'LifecycleNode' in code.names
    if managed and (why := why_no_method(code)):
        return why
    return why_by_code(f'no_{kind}', run, kind=kind, topic=base, type=wanted)


def why_no_method(code: Code, method: str = 'on_configure') -> Cause | None:
    """
    Explain a lifecycle node that lacks a method, and name its most similar one.

    For a method other than ``on_configure``, return a cause only if a similar name exists.
    """
    near = close_name(method, code.functions.keys() - TRANSITIONS)
    if code.defines(method) or not (near or method == 'on_configure'):
        return None
    meant = f' Your {near}() has a similar name.' if near else ''
    return cause_of('method_name', method=method, near=meant, name=near)


def why_refused(run: Run, name: str, again: bool = False) -> Cause:
    """
    Explain a transition that ended with FAILURE or ERROR, from the code.

    rclpy swallows exceptions in transition callbacks: there is no log line and no traceback.

    :param name: name of the transition, such as ``configure``
    :param again: whether the same transition succeeded earlier
    """
    code = Code(run.files)
    if why := why_no_method(code):
        return why
    declares = place_of(code, f'declare_parameter()@def:on_{name}')
    if again and declares and not code.names & {'undeclare_parameter', 'has_parameter'}:
        return cause_of('declared_again', name=name)
    if again:
        return cause_of('refused_again', name=name)
    taken = code.parameters(f'on_{name}')
    if taken is not None and len(taken) < 2:
        return cause_of('callback_arguments', name=name, first=(*taken, 'self')[0])
    known = homes(run.names)
    missing = next((one for one in known if one in code.undefined_names), '')
    if missing:
        return cause_of('missing_import', name=missing, callback=name, home=known[missing])
    alone = [cause_of('refuses_alone', name=name)] if name == 'activate' else []
    return cause_of('refused', name=name, closer=alone)


def _why_longer_name(run: Run, kind: str, topic: str, type_name: str) -> Cause | None:
    """Explain a topic with the right last part but a wrong prefix."""
    base = topic.rpartition('/')[2]
    for end in run.recording.endpoints(kind):
        seen, private = end['topic'], f'{end["node"]}/{base}'
        longer = seen == private or (seen.endswith(f'/{base}') and not topic.endswith(seen))
        if end['type'] == type_name and longer:
            situation = 'private_name' if seen == private else 'namespace_in_the_name'
            return cause_of(situation, kind=kind, base=base, seen=seen)
    return None


def why_no_verdict(run: Run) -> Cause | None:
    """Explain why a lifecycle node ended: a transition callback returned the wrong type."""
    found = _NO_VERDICT.search(str(run.recording.process.get('stderr', '')))
    if found is None:
        return None
    return cause_of('no_return' if found[1] == 'NoneType' else 'wrong_return', type=found[1])


def why_silent(run: Run) -> Cause | None:
    """Explain why a node with the right endpoints publishes nothing."""
    ended = why_it_ended(run)
    if not ended and ended_after_refusal(run):
        return None
    if ended and ended.cause_id not in LIMITS:
        return ended
    # An exception that ended a thread explains more than a limit that the other threads exceeded.
    thread = why_thread_ended(run)
    if other := thread or ended or why_other_is_spun(run):
        return other
    if not no_node_answered(run):
        return why_late(run)
    return why_it_sleeps(run) or why_by_code('idle', run)


def while_running(run: Run, asked: Specification, place: int, short: bool = True) -> Run:
    """
    Return the run without the end of the program, unless this end may explain a wrong answer.

    The end explains nothing if the program got a later input, or if no message or line is missing.

    :param place: index of the input, or of the burst, with the wrong answer
    :param short: whether a message or line is missing from the answer
    """
    sent, last = len(run.recording.of('input')), place + len(asked.row(place))
    if run.recording.process.get('exit') is None or sent < last or (short and sent == last):
        return run
    running = {'exit': None, 'stderr': ''}
    events = [
        {**one, **running} if one['event'] == 'process' else one for one in run.recording.events
    ]
    return replace(run, recording=Recording(run.recording.header, events))


def no_node_answered(run: Run) -> bool:
    """Return whether the probe sent a request to every node at the end, and none responded."""
    asked = run.recording.of('asked')
    return bool(asked) and not any(event['answered'] for event in asked)


def why_thread_ended(run: Run) -> Cause | None:
    """
    Explain a program that keeps running after an exception ended the thread that spins its node.

    An exception in any other thread is the cause only if there is no node or no node answers.
    """
    said = str(run.recording.process.get('stderr', ''))
    for thread in said.split(_THREAD, _MOST_THREADS)[1:]:
        trace, spins = traceback_of(run, thread), _SPINS.search(thread)
        idle = not run.recording.nodes or no_node_answered(run)
        if trace is not None and trace.line and (spins or idle):
            why = exception_cause(trace)
            which = 'the thread that spins the node' if spins else 'a thread of your program'
            return replace(why, text=f'{why.text.removesuffix(".")}. The exception ended {which}.')
    return None


def why_other_is_spun(run: Run) -> Cause | None:
    """Explain a node that does not answer at the end although another node does."""
    answered = {event['node'] for event in run.recording.of('asked', answered=True)}
    silent = {event['node'] for event in run.recording.of('asked')} - answered
    kinds = ('publisher', 'subscription')
    working = {end['node'] for kind in kinds for end in run.recording.endpoints(kind)}
    # A node without endpoints is not the cause, unless the nodes that answer have none either.
    if answered & working:
        silent &= working
    if not answered or not silent:
        return None
    first = min(silent & working or silent)
    other, mine = (name.rpartition('/')[2][:60] for name in (min(answered), first))
    return cause_of('other_node_spun', other=other, mine=mine)


def why_it_sleeps(run: Run) -> Cause | None:
    """Explain a node that is late because a callback sleeps, unless the exercise requires this."""
    pause = None if run.facts.get('slow_callback') else pause_in_callback(run.files)
    if pause is None:
        return None
    callback, line = pause
    name = f'{callback[:60]}()' if callback else 'A callback'
    return cause_of('sleeps_in_callback', name=name, line=line)


def why_late(run: Run) -> Cause | None:
    """Explain a timer whose period has the wrong unit, so that its first call is too late."""
    code = Code(run.files)
    for timer in ('create_timer', 'Timer'):
        if late := [one for one in code.numbers(timer) if one >= LONG_S]:
            minutes = late[0] / 60
            return cause_of('period_unit', timer=timer, period_s=late[0], minutes=minutes)
    return None


def why_no_message(run: Run) -> Cause:
    """Explain why a running node with the right publisher publishes nothing."""
    return why_silent(run) or why_by_code('no_message', run)


def how_to_investigate(run: Run) -> str:
    """
    Return how to investigate if no cause is certain, with tools that show what the grader saw.

    Only the last part of a topic name is shown, because the namespace of a hidden exam is secret.
    """
    topics = {end['topic'].rpartition('/')[2][:60] for end in run.recording.endpoints('publisher')}
    if not run.recording.nodes:
        return ''
    tools = ', run logs() in a cell,'
    if topics:
        tools = f" and run echo('{min(topics)}') in a cell, or ros2 topic echo in a terminal,"
    return f'Try it: start your node{tools} and compare the output with what is expected.'
