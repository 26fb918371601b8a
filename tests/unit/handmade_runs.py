"""Handmade recordings: events as the probe writes them, the run of a program, failed checks."""

import pytest

from autograder.exam.exam import Failed, Run
from autograder.recording import Recording


def at(clock_s, kind='message', **facts):
    """Return an event at a virtual time [s]."""
    return {'event': kind, 'clock_ns': round(clock_s * 1e9), **facts}


def message(clock_s, topic='/alive', data=None, **facts):
    return at(clock_s, topic=topic, data={} if data is None else data, **facts)


def sent(*clocks_s):
    """Return the inputs at these times, numbered from 0."""
    return [at(clock, 'input', index=place, data={}) for place, clock in enumerate(clocks_s)]


def publisher(topic, node, type_name, **facts):
    """Return an endpoint of a graph; with kind='subscription', a subscription."""
    return {'kind': 'publisher', 'topic': topic, 'node': node, 'type': type_name, **facts}


def graph(*endpoints, nodes=(), when='end'):
    """Return the graph of these endpoints with their nodes, and of further nodes."""
    names = [*dict.fromkeys(one['node'] for one in endpoints), *nodes]
    return at(1.0, 'graph', when=when, nodes=names, endpoints=list(endpoints))


def run_of(*events, code='', file='n.py', facts=None, reason='complete', **process):
    """
    Return the run of a program.

    :param facts: those of the exam
    :param reason: why the run ended; by default as planned, after 20 s
    :param process: facts about the program's process, such as its output
    """
    end = at(20.0, 'end', reason=reason)
    process = {'exit': None, 'killed': '', 'stdout': '', 'stderr': '', **process}
    events = (*events, end, {'event': 'process', **process})
    return Run({file: code}, Recording({}, events), facts or {})


def failure(check, *given):
    """Return the failure of a check."""
    with pytest.raises(Failed) as failed:
        check(*given)
    return failed.value


def why(check, *given):
    """Return the cause of a check's failure, or None if none is known."""
    return failure(check, *given).why


def cause_id_of(check, run):
    """Return the id of the cause of a failure ('' if unknown), or None if the check passes."""
    try:
        check(run)
    except Failed as failed:
        return failed.why.cause_id if failed.why else ''
    return None
