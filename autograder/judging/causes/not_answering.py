"""
Explain a node that answers late or not at all, in a program that runs until the end.

Possible causes: an exception ended its thread, the program spins a different node, or a callback
sleeps.
"""

from __future__ import annotations

from dataclasses import replace
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.redaction import asked
from autograder.judging.causes.text_table import cause_of
from autograder.judging.causes.tracebacks import traceback_of
from autograder.recording import Recording
from autograder.submission.code.learners_code import pause_in_callback

THREAD = 'Exception in thread '
"""Start of Python's message about an exception that ended a thread."""
MOST_THREADS = 20  # maximum number of threads that are examined
SPINS = re.compile(r'^ +File .*, in _?spin\w*$', re.MULTILINE)


def nobody_answers(run: Run) -> bool:
    """Return whether the probe sent a request to every node at the end, and none responded."""
    asked_nodes = run.recording.of('asked')
    return bool(asked_nodes) and not any(event['answered'] for event in asked_nodes)


def why_thread_ended(run: Run) -> Cause | None:
    """
    Explain a program that keeps running after an exception ended the thread that spins its node.

    An exception in any other thread is the cause only if there is no node or no node answers.
    """
    said = str(run.recording.process.get('stderr', ''))
    for thread in said.split(THREAD, MOST_THREADS)[1:]:
        # Keep the inputs of a hidden exam, so that traceback_of() can remove them from the
        # message.
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
        which = 'the thread that spins the node' if spins else 'a thread of your program'
        return replace(why, text=f'{why.text.removesuffix(".")}. It ended {which}.')
    return None


def why_other_is_spun(run: Run) -> Cause | None:
    """Explain a node that does not answer at the end although another node does."""
    asked_nodes = run.recording.of('asked')
    names = {event['node'] for event in asked_nodes}
    answered = {event['node'] for event in asked_nodes if event['answered']}
    if not answered:
        return None
    silent = sorted(names - answered, key=lambda node: (not _works(run, node), node))
    # A node without endpoints is not the cause, unless the nodes that answer have none either.
    if silent and (_works(run, silent[0]) or not any(_works(run, node) for node in answered)):
        other, mine = (name.rpartition('/')[2][:60] for name in (min(answered), silent[0]))
        return cause_of('other_node_spun', other=other, mine=mine)
    return None


def _works(run: Run, node: str) -> bool:
    """Return whether a node has a publisher or a subscription."""
    kinds = ('publisher', 'subscription')
    return any(end['node'] == node for kind in kinds for end in run.recording.endpoints(kind))


def why_it_sleeps(run: Run) -> Cause | None:
    """Explain a node that is late because a callback sleeps, unless the exercise requires this."""
    pause = None if run.facts.get('slow_callback') else pause_in_callback(run.files)
    if pause is None:
        return None
    name = f'{pause.callback[:60]}()' if pause.callback else 'A callback'
    return replace(cause_of('sleeps_in_callback', name=name), line=pause.line)
