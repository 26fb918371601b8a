"""
Why a check failed: the likely cause, from what the probe saw and how the program ended.

What a program printed about itself may name a cause; it never decides a verdict.  When nothing
points anywhere, the answer is None: a misleading cause is worse than none.
"""

from __future__ import annotations

from collections.abc import Iterable
import difflib
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes import not_answering as stalled
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.tracebacks import traceback_of
from autograder.judging.packages import why_no_program
from autograder.submission.code.learners_code import Code, texts_in

_NO_VERDICT = re.compile(r"'(\w{1,40})' object has no attribute 'to_label'")
_IN_VAIN = 'Failed to trigger lifecycle state machine transition'
_CALLS_BACK = {'create_timer', 'create_subscription', 'create_service', 'create_rate'}

LONG_S = 50.0
"""A period [s] that no exercise has; who writes it thinks of milliseconds."""

LIMITS = {
    'waits_outside': (
        'it waited for something outside of Python and ROS that never came',
        'a lock on a file, a system call by its number, or another program that never ends',
    ),
    'probe_broken': (
        'it sent packets that no ROS program sends, and broke what listens to it',
        'code that writes into sockets of its own',
    ),
    'cpu_limit': ('it used more than 20 s of processor time', 'a loop that never waits'),
    'busy_before_node': (
        'it computed for 3 s without a pause, and no node was seen',
        'a loop that never waits: before the node is created, or one that publishes',
    ),
    'memory_limit': ('it used more than 1 GiB of memory', 'a list that grows without bound'),
    'output_limit': ('it printed more than 8 MB', 'a print in a loop without a pause'),
    'inode_limit': ('it made more than 20000 files', 'a loop that creates files'),
    'disk_limit': ('it wrote more than 64 MB into files', 'a loop that writes into a file'),
    'too_much_recorded': ('it sent more than 32 MB', 'a publish in a loop without a pause'),
    'too_many_events': (
        'it sent thousands of messages',
        'a publish in a loop without a pause, or a create_timer() in a callback',
    ),
}
OF_A_PACKAGE = {
    'cpu_limit': 'its build and the run used more than 50 s of processor time together',
}
"""What is another limit where a package is built first."""


def why_it_ended(run: Run) -> Cause | None:
    """Explain a program that is gone or was ended; empty if it was alive to the end."""
    recording = run.recording
    killed = str(recording.process.get('killed', '')) or recording.end_reason
    package = bool(run.facts.get('package'))
    if killed in LIMITS:
        what, why = LIMITS[killed]
        what = OF_A_PACKAGE.get(killed, what) if package else what
        return Cause(killed, f'The program was ended: {what}.', f'Look for {why}.')
    if cause := why_no_program(run) or why_no_verdict(run):
        return cause
    if died_in_vain(run):
        return None
    trace = traceback_of(run)
    if trace is not None and recording.process.get('exit') is not None:
        return exception_cause(trace)
    code = recording.process.get('exit')
    if code == 0 and recording.of('input'):
        return Cause(
            'exited_early',
            f'The program ended by itself after message number {len(recording.of("input"))}.',
            'A node lives until it is stopped: rclpy.spin(node), and no sys.exit() in a callback.',
        )
    if code == 0:
        return _why_over(run, Code(run.files))
    if code is not None and Code(run.files).ends_itself:
        if not recording.nodes:
            return Cause(
                'ends_itself',
                f'The program ends itself, with exit code {code}, before it has a node.',
                'Take out the exit() that comes first; a node is also started with arguments of '
                'ROS, such as --ros-args, so how many there are is no mistake.',
            )
        return Cause(
            'ends_itself',
            f'The program ends itself, with exit code {code}.',
            'Use return to leave a callback; exit() and sys.exit() end the whole program.',
        )
    if code is not None:
        return Cause('died', f'The program died with exit code {code}.', 'Run it in a terminal.')
    return None


def died_in_vain(run: Run) -> bool:
    """
    Return whether the program died of a transition that its state does not allow.

    That is the consequence of an earlier refusal, and explains nothing.
    """
    return _IN_VAIN in str(run.recording.process.get('stderr', ''))


def _why_over(run: Run, code: Code) -> Cause:
    """Explain a program that came to its end by itself, by what it says."""
    # Half a second later it was still there, so it is no matter of a single spin_once().
    if run.recording.of('graph', when='start') and ('spin' in code.calls or code.loops):
        if code.catches_all and not code.ends_itself:
            return Cause(
                'swallowed',
                'Your node was at work, and then the program ended by itself. Your code catches '
                'every exception: a mistake in a callback may have been caught with the rest.',
                'Take that except out, and read what Python says. For the end of a program, catch '
                'KeyboardInterrupt and ExternalShutdownException only.',
            )
        return Cause(
            'exited_early',
            'Your node was at work, and then the program ended by itself.',
            'A node lives until it is stopped: rclpy.spin(node) in main(). To leave a callback, '
            'use return, and neither exit() nor SystemExit.',
        )
    texts = texts_in(run.files)
    # An entry point names main() in a text.
    unused = code.defines_unused('main') and not any(text.endswith(':main') for text in texts)
    if unused or ('__name__' in code.names and '__main__' not in texts):
        return Cause(
            'main_not_called',
            'Your program defines main() and never calls it.',
            "Write as its last lines: if __name__ == '__main__': and below it, indented, main().",
        )
    if 'spin_once' in code.calls and not code.loops:
        return Cause(
            'spins_once',
            'spin_once() serves one callback and returns, and then the program ends.',
            'Call rclpy.spin(node), which goes on until the program is stopped.',
        )
    if code.names and not _spins(code):
        return Cause(
            'no_spin',
            'Nothing in your code spins the node, so the program runs to its end at once.',
            'In main(), call rclpy.spin(node), or spin() of the executor that has your nodes; it '
            'returns when the program is stopped.',
        )
    return Cause(
        'exited_early',
        'The program ended by itself before anything could happen.',
        'Does main() call rclpy.spin(node)? Without it the program runs to its end at once.',
    )


def _spins(code: Code) -> bool:
    return any(name.startswith('spin') for name in code.names)


def close_name(wanted: str, names: Iterable[str]) -> str:
    """Return the name that looks like a slip of the wanted one, or nothing."""
    found = difflib.get_close_matches(wanted, sorted(set(names)), n=1, cutoff=0.6)
    return found[0] if found else ''


def why_no_node(run: Run, wanted: str) -> Cause:
    """
    Explain why a node was not seen.

    :param wanted: full node name, ``/name``
    """
    others = [name for name in run.recording.nodes if name != wanted]
    near = close_name(wanted, others) or (others[0] if others else '')
    if near:
        return Cause(
            'node_name',
            f'There is a node called {near[1:]}.',
            f"Give super().__init__() the name '{wanted.rpartition('/')[2]}'.",
        )
    return why_it_ended(run) or stalled.why_thread_ended(run) or _why_unseen(Code(run.files))


def _why_destroyed(code: Code) -> Cause | None:
    """Explain a node that is destroyed before it is spun; a lifecycle node can be seen even so."""
    destroyed, spun = (code.calls.get(name, ()) for name in ('destroy_node', 'spin'))
    first = [(one.lineno, one.col_offset) for calls in (destroyed, spun) for one in calls[:1]]
    if not destroyed or not spun or first[0] > first[1]:
        return None
    return Cause(
        'destroyed_early',
        'Your node is gone before it is spun: destroy_node() is called before spin().',
        'Destroy it at the very end, in finally.',
    )


def _why_unseen(code: Code) -> Cause:
    """Explain a program that runs and shows no node, by what it says."""
    if destroyed := _why_destroyed(code):
        return destroyed
    if any(name.endswith('Node') or name in ('__init__', 'create_node') for name in code.calls):
        return Cause(
            'no_node',
            'The program runs, and no node could be seen, although your code has one.',
            'Does a loop or input() keep main() from making it? Start it, and run nodes().',
        )
    return Cause(
        'no_node',
        'The program runs but never creates a node.',
        'Create your node in main(): rclpy.init(), then the class, then rclpy.spin(node).',
    )


def why_no_endpoint(run: Run, kind: str, topic: str, type_name: str) -> Cause:
    """
    Explain why no endpoint of the right name and type was seen.

    :param kind: ``'publisher'`` or ``'subscription'``
    """
    recording = run.recording
    create = f'create_{kind}'
    for end in recording.endpoints(kind, topic):
        if end['type'] != type_name:
            return Cause(
                'wrong_type',
                f'Your {kind} on {topic} has the type {end["type"]}.',
                f'Pass the class {type_name.rpartition("/")[2]} to {create}().',
            )
    if why := _why_longer_name(run, kind, topic, type_name):
        return why
    others = [end['topic'] for end in recording.endpoints(kind)]
    near = close_name(topic, others)
    other = {'publisher': 'subscription', 'subscription': 'publisher'}[kind]
    if not near and recording.endpoints(other, topic):
        return Cause(
            'wrong_direction',
            f'Your node has a {other} on {topic}, not a {kind}.',
            f'Use {create}().',
        )
    same_type = (end['topic'] for end in recording.endpoints(kind) if end['type'] == type_name)
    near = near or next(same_type, '')
    if near and topic.endswith(near):
        return Cause(
            'absolute_name',
            f'Your {kind} uses the absolute name {near}, which stays outside the namespace '
            f'{topic.removesuffix(near)}.',
            f"Give {create}() the name '{near[1:]}', without a slash in front.",
        )
    if near:
        return Cause(
            'topic_name',
            f'Your {kind} uses the topic {near}; did you mean {topic}?',
            f"Give {create}() the name '{_relative(run, topic)}'.",
        )
    ended = why_it_ended(run)
    if ended:
        return ended
    if not recording.nodes:
        return why_no_node(run, '/?')
    if kind == 'publisher' and _is_managed(run):
        base, name = topic.rpartition('/')[2], type_name.rpartition('/')[2]
        return why_no_configure(Code(run.files)) or Cause(
            'no_endpoint',
            'Your on_configure() creates no publisher.',
            f"In on_configure(): self.create_lifecycle_publisher({name}, '{base}', 10).",
        )
    return Cause(
        'no_endpoint', f'Your node creates no {kind}.', f'Call self.{create}() in __init__().'
    )


def _is_managed(run: Run) -> bool:
    """Return whether the program has a lifecycle node, by what its code says."""
    return 'LifecycleNode' in Code(run.files).names


def why_no_configure(code: Code) -> Cause | None:
    """Explain a lifecycle node without on_configure(), with the method that is meant to be it."""
    if code.makes('on_configure'):
        return None
    near = close_name('on_configure', code.functions)
    text = f'Nobody calls your {near}(); did you mean on_configure()? rclpy calls the method of '
    return Cause(
        'method_name',
        f'{text}exactly this name.'
        if near
        else 'There is no method on_configure() in your code; rclpy calls the one of exactly this '
        'name.',
        'Write: def on_configure(self, state):',
    )


def _why_longer_name(run: Run, kind: str, topic: str, type_name: str) -> Cause | None:
    """Explain a topic whose name ends as it should, with too much before it."""
    base = topic.rpartition('/')[2]
    plain = f"Give create_{kind}() the plain name '{base}'."
    for end in run.recording.endpoints(kind):
        if end['type'] != type_name or not end['topic'].endswith(f'/{base}'):
            continue
        if end['topic'] == f'{end["node"]}/{base}':
            return Cause(
                'private_name',
                'With ~/ the topic belongs to the node alone: its name contains that of the node.',
                plain,
            )
        if not topic.endswith(end['topic']):
            return Cause(
                'namespace_in_the_name',
                'The name of your topic contains a namespace that is not asked for.',
                plain,
            )
    return None


def _relative(run: Run, topic: str) -> str:
    """Return the name that the code gives a topic; the node's namespace is put before it."""
    homes = [name.rpartition('/')[0] + '/' for name in run.recording.nodes]
    return topic.removeprefix(max((home for home in homes if topic.startswith(home)), default='/'))


def why_no_verdict(run: Run) -> Cause | None:
    """Explain a lifecycle node that died because a transition callback returned something else."""
    found = _NO_VERDICT.search(str(run.recording.process.get('stderr', '')))
    if found is None:
        return None
    if found[1] == 'NoneType':
        return Cause(
            'no_return',
            'A transition callback ends without return, so rclpy does not know how it went.',
            'End each on_...() with return super().on_...(state), or with a '
            'TransitionCallbackReturn.',
        )
    return Cause(
        'wrong_return',
        f'A transition callback returns a {found[1]}, which rclpy does not understand.',
        'Return a TransitionCallbackReturn, or what super().on_...(state) returns.',
    )


def why_silent(run: Run) -> Cause | None:
    """Explain a node whose endpoints are right and from which nothing comes."""
    ended = why_it_ended(run)
    if not ended and died_in_vain(run):
        return None
    if ended and ended.cause_id not in LIMITS:
        return ended
    # What has ended a thread explains more than the limit that the rest of the program passed.
    if other := stalled.why_thread_ended(run) or ended or stalled.why_other_is_spun(run):
        return other
    return _why_nobody_answers(run) if stalled.nobody_answers(run) else why_late(run)


def _why_nobody_answers(run: Run) -> Cause:
    """Explain a node that is there at the end and not spun then, by what the code says."""
    code = Code(run.files)
    own = stalled.why_it_sleeps(run) or stalled.why_it_loops(code) or _why_destroyed(code)
    if own:
        return own
    if any(name.endswith('Executor') for name in code.calls) and 'add_node' not in code.names:
        return Cause(
            'never_spun',
            'Your executor has no node, so no callback ever runs.',
            'Call executor.add_node(node) for each node before executor.spin().',
        )
    if _spins(code):
        return Cause(
            'blocked',
            'Your node answers nothing at the end: a callback does not return, or your program '
            'loops or waits outside of spin().',
            'A callback must return: use a timer instead of a loop or time.sleep().',
        )
    return Cause(
        'never_spun',
        'Your node exists but nobody spins it, so no callback ever runs.',
        'Call rclpy.spin(node) in main(), with the node that you created, and let no loop stand '
        'before it.',
    )


def why_late(run: Run) -> Cause | None:
    """Explain a timer whose first call is far away, because its period is in other units."""
    code = Code(run.files)
    for timer in ('create_timer', 'Timer'):
        for period_s in code.first_numbers(timer):
            if period_s < LONG_S:
                continue
            return Cause(
                'period_unit',
                f'{timer}() gets {period_s:g}, and that is seconds: the first call comes '
                f'after {period_s / 60:.3g} minutes.',
                'Write the period in seconds: 0.5 for 500 ms.',
            )
    return None


def why_no_message(run: Run) -> Cause:
    """Explain a node that lives, whose publisher is right, and from which nothing comes."""
    if found := why_silent(run):
        return found
    code = Code(run.files)
    if code.names and 'publish' not in code.names:
        return Cause(
            'never_publishes',
            'Your code never calls publish().',
            'Call self.publisher.publish(message) in the callback.',
        )
    if _is_managed(run):
        return _why_not_active(code)
    if code.names and not _CALLS_BACK & code.names:
        return Cause(
            'no_timer',
            'Your code creates no timer, so nothing calls the method that publishes.',
            'Create a timer in __init__(): self.create_timer(1.0, self.callback).',
        )
    return Cause(
        'silent',
        'The publisher is there, and no message comes from it: the callback that publishes is '
        'never called, or it returns too early.',
        'Which method does the timer or the subscription call? Put a log line first into it, '
        'start the node, and look at logs().',
    )


def _why_not_active(code: Code) -> Cause:
    """Explain an active lifecycle node that has its publisher and sends nothing."""
    if 'on_activate' in code.functions and 'on_activate' not in code.calls:
        return Cause(
            'stays_off',
            'Your on_activate() replaces the inherited one, which switches the publishers on.',
            'End it with return super().on_activate(state).',
        )
    if 'create_timer' not in code.names:
        return Cause(
            'no_timer',
            'Your code creates no timer, so nothing calls the method that publishes.',
            'In on_configure(): self.create_timer(1.0, self.callback).',
        )
    return Cause(
        'stays_off',
        'The node is active, but its publisher or its timer is not.',
        'Does the timer run, and does its callback publish? Log a line in it. An on_activate() of '
        'your own ends with return super().on_activate(state).',
    )


def how_to_look(run: Run) -> str:
    """
    Return what to try where no cause is sure: how to see with own eyes what was seen here.

    Topics go by their last part, because the namespace of a hidden exam is nobody's business.
    """
    topics = {end['topic'].rpartition('/')[2][:60] for end in run.recording.endpoints('publisher')}
    if not run.recording.nodes:
        return ''
    if topics:
        return (
            f"Look yourself: start your node and run echo('{min(topics)}') in a cell, or "
            f'ros2 topic echo in a terminal, and compare with what is expected.'
        )
    return (
        'Look yourself: start your node, run logs() in a cell, and compare with what is expected.'
    )
