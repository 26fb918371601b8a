"""
Why a node does not answer, or answers late, in a program that runs to the end.

Its thread has ended with an exception, another node is spun, a loop takes the place of a timer, or
one of its callbacks sleeps.  :mod:`causes` asks here.
"""

from __future__ import annotations

from dataclasses import replace
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.redaction import asked
from autograder.judging.causes.tracebacks import traceback_of
from autograder.recording import Recording
from autograder.submission.code.learners_code import Code, pause_in_callback

THREAD = 'Exception in thread '
"""How Python begins what it prints when an exception has ended a thread, and not the program."""
MOST_THREADS = 20  # that are looked at
SPINS = re.compile(r'^ +File .*, in _?spin\w*$', re.MULTILINE)


def nobody_answers(run: Run) -> bool:
    """Return whether the probe asked every node at the end, and none answered."""
    asked_nodes = run.recording.of('asked')
    return bool(asked_nodes) and not any(event['answered'] for event in asked_nodes)


def why_thread_ended(run: Run) -> Cause | None:
    """
    Explain a program that lives on after an exception has ended the thread that spins its node.

    An exception in another thread explains only that there is no node, or nobody ever spins it.
    """
    said = str(run.recording.process.get('stderr', ''))
    for thread in said.split(THREAD, MOST_THREADS)[1:]:
        # With what a hidden exam has sent: the words of an exception must not show it.
        events = [
            *run.recording.of('input'),
            *asked(run),
            {**run.recording.process, 'stderr': thread},
        ]
        trace = traceback_of(replace(run, recording=Recording({}, events)))
        spins = bool(SPINS.search(thread))
        idle = not run.recording.nodes or nobody_answers(run)
        if trace is None or not trace.line or not (spins or idle):
            continue
        why = exception_cause(trace)
        # It is not the program that stopped.
        text = why.text.replace('The program stopped with an exception', 'An exception was raised')
        which = 'the thread that spins the node' if spins else 'a thread of your program'
        return replace(why, text=f'{text.removesuffix(".")}. It ended {which}.')
    return None


def why_other_is_spun(run: Run) -> Cause | None:
    """Explain a node that does not answer at the end while another one of the program does."""
    asked_nodes = run.recording.of('asked')
    names = {event['node'] for event in asked_nodes}
    answered = {event['node'] for event in asked_nodes if event['answered']}
    if not answered:
        return None
    silent = sorted(names - answered, key=lambda node: (not _works(run, node), node))
    # A helper that nobody spins explains nothing, unless the one that is spun has no work either.
    if silent and (_works(run, silent[0]) or not any(_works(run, node) for node in answered)):
        other, mine = (name.rpartition('/')[2][:60] for name in (min(answered), silent[0]))
        return Cause(
            'other_node_spun',
            f'The node {other} is spun and {mine} is not, so the callbacks of {mine} never run.',
            'Spin the node that has the work, or give both to one executor with add_node().',
        )
    return None


def _works(run: Run, node: str) -> bool:
    """Tell whether a node has a publisher or a subscription of its own."""
    kinds = ('publisher', 'subscription')
    return any(end['node'] == node for kind in kinds for end in run.recording.endpoints(kind))


def why_it_loops(code: Code) -> Cause | None:
    """
    Explain a node that nobody spins because a loop does all.

    There is no callback in its code, so none can be what does not return.
    """
    calls = ('create_timer', 'create_subscription', 'create_service', 'create_rate', 'on_')
    called = any('callback' in name or name.startswith(calls) for name in code.names)
    if called or not code.loops:
        return None
    return Cause(
        'own_loop',
        'Your program does all in a loop of its own, so nobody spins its node.',
        'Use self.create_timer(...) with the period in seconds, and rclpy.spin(node), instead of '
        'a loop.',
    )


def why_it_sleeps(run: Run) -> Cause | None:
    """Explain a node that is late because a callback sleeps, unless the exercise asks for it."""
    pause = None if run.facts.get('slow_callback') else pause_in_callback(run.files)
    if pause is None:
        return None
    name = f'{pause.callback[:60]}()' if pause.callback else 'A callback'
    return Cause(
        'sleeps_in_callback',
        # Line 1 of the cell is the magic line.
        f'{name} sleeps in line {pause.line + 1} of the cell, and while a callback sleeps, the '
        'node does nothing else: no timer ticks, no message is taken.',
        'Take the sleep out. The period of a timer is the pause, and a callback returns at once.',
    )
