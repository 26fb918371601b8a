"""
Why nothing came of a program, as far as its code shows: one table for all such situations.

A row has the name of a cause and the situations in which it may hold, then what the code must
have, then what the learner is told, and the repair.  The first row that fits is the cause, so a
situation ends with a row that ``always`` fits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from autograder.exam.exam import Cause, Run
from autograder.judging.text_table import rows
from autograder.submission.code.learners_code import Code


class Row(NamedTuple):
    """
    A cause that code shows.

    :param situations: words, such as ``idle``; the functions that ask explain them
    :param words: all must hold: a name that the code uses, ``name()`` if it calls it, a fact of
        :data:`_FACTS`; ``!`` before a word means that it must not hold
    :param text: with names in braces, which the situation gives
    """

    cause_id: str
    situations: str
    words: str
    text: str
    try_this: str


_TABLE = """
exited_early|mid_run
always
The program ended by itself after message number {count}.
A node lives until it is stopped: rclpy.spin(node), and no sys.exit() in a callback.

swallowed|over_later
serves catches_all !ends_itself
Your node was running, and then the program ended. Your code catches every exception, so it may
  hide a mistake in a callback.
Remove that except and read Python's error message. To end a program cleanly, catch only
  KeyboardInterrupt and ExternalShutdownException.

exited_early|over_later
serves
Your node was running, and then the program ended.
Call rclpy.spin(node) in main(): it runs until the program is stopped. To leave a callback, use
  return, not exit() or SystemExit.

main_not_called|over over_later
main_unused
Your program defines main() and never calls it.
Write as its last lines: if __name__ == '__main__': and below it, indented, main().

spins_once|over over_later
spin_once() !loops
spin_once() runs one callback and returns, and then the program ends.
Call rclpy.spin(node), which runs until the program is stopped.

no_spin|over over_later
!spins
Your code spins no node, so the program ends at once.
In main(), call rclpy.spin(node), or spin() of the executor that has your nodes; it returns when
  the program is stopped.

exited_early|over over_later
always
The program ended by itself before the checks could begin.
Does main() call rclpy.spin(node)? Without it the program ends at once.

ends_itself|died_unseen
ends_itself
Your program calls exit() before it has a node; the exit code is {code}.
Remove the exit() that comes first. ROS adds arguments such as --ros-args, so do not test how many
  arguments there are.

ends_itself|died
ends_itself
Your program calls exit(); the exit code is {code}.
Use return to leave a callback; exit() and sys.exit() end the whole program.

died|died died_unseen
always
The program died with exit code {code}.
Run it in a terminal and read what it prints.

destroyed_early|unseen idle
destroyed_first
Your program calls destroy_node() before spin().
Call destroy_node() at the very end, in finally.

no_node|unseen
creates_node
The program runs, but its node does not appear in the graph.
Does a loop or input() keep main() from creating it? Start it, and run nodes().

no_node|unseen
always
The program runs but never creates a node.
Create your node in main(): rclpy.init(), then the class, then rclpy.spin(node).

own_loop|idle
loops !has_callbacks
Your program runs its own loop and never spins its node.
Use self.create_timer(...) with the period in seconds, and rclpy.spin(node), instead of a loop.

never_spun|idle
creates_executor !add_node
Your executor has no node, so no callback ever runs.
Call executor.add_node(node) for each node before executor.spin().

blocked|idle
spins
At the end, your node answers no request: a callback does not return, or your program loops or
  waits outside spin().
A callback must return: use a timer instead of a loop or time.sleep().

never_spun|idle
always
Your node exists, but your program does not spin it, so no callback ever runs.
Call rclpy.spin(node) in main() with the node that you created, and put no loop before it.

never_publishes|no_message
!publish
Your code never calls publish().
Call self.publisher.publish(message) in the callback.

stays_off|no_message
LifecycleNode overrides_activate
Your on_activate() replaces the inherited one, which switches the publishers on.
End it with return super().on_activate(state).

no_timer|no_message
LifecycleNode !create_timer
Your code creates no timer, so nothing calls the method that publishes.
In on_configure(): self.create_timer(1.0, self.callback).

stays_off|no_message
LifecycleNode
The node is active, but its publisher or its timer is not.
Does the timer run, and does its callback publish? Log a line in it. End your own on_activate()
  with return super().on_activate(state).

no_timer|no_message
!create_timer !create_subscription !create_service !create_rate
Your code creates no timer, so nothing calls the method that publishes.
Create a timer in __init__(): self.create_timer(1.0, self.callback).

silent|no_message
always
The publisher exists but sends no message: its callback is never called, or returns too early.
Which method does the timer or the subscription call? Begin that method with a log line, start the
  node, and call logs().

no_timer|no_line
!create_timer !create_rate
Your code creates no timer, so nothing calls the callback.
Call {call}.

debug_level|no_line
debug()
ROS hides lines at level DEBUG unless the program is started with a lower log level.
Use self.get_logger().info(...).

swallowed|no_line
catches_all
Your node logs nothing, and your code hides every exception in the callback.
Remove try and except from the callback, and read Python's error message.

silent|no_line
always
No timer causes a log line: it does not exist, its period is too long, or its callback does not
  log.
Is {call} reached? The period is in seconds: 1000 is a quarter of an hour.

no_endpoint|no_publisher
LifecycleNode
Your on_configure() creates no publisher.
In on_configure(): self.create_lifecycle_publisher({type}, '{topic}', 10).

no_endpoint|no_publisher no_subscription
always
Your node creates no {kind}.
Call self.create_{kind}() in __init__().
"""

TABLE = tuple(Row(*head.split('|'), *rest) for head, *rest in rows(_TABLE))


def why_by_code(situation: str, run: Run, **names: object) -> Cause:
    """
    Return the first cause of a situation that the code shows.

    Only such a last row fits code that Python cannot read.

    :param names: what the texts of the situation have in braces
    """
    code = Code(run.files)
    here = (row for row in TABLE if situation in row.situations.split())
    row = next(row for row in here if row.words == 'always' or _fits(code, row.words))
    return Cause(row.cause_id, row.text.format(**names), row.try_this.format(**names))


def _fits(code: Code, words: str) -> bool:
    if not code.names:
        return False
    return all(_holds(code, word.removeprefix('!')) != (word[0] == '!') for word in words.split())


def _holds(code: Code, word: str) -> bool:
    if fact := _FACTS.get(word):
        return fact(code)
    return word[:-2] in code.calls if word.endswith('()') else word in code.names


def _has_callbacks(code: Code) -> bool:
    starts = ('create_timer', 'create_subscription', 'create_service', 'create_rate', 'on_')
    return any('callback' in name or name.startswith(starts) for name in code.names)


def _main_unused(code: Code) -> bool:
    """Return whether nothing calls main(); an entry point of a package names it in a text."""
    unused = code.defines_unused('main') and not any(one.endswith(':main') for one in code.texts)
    return unused or ('__name__' in code.names and '__main__' not in code.texts)


def _destroyed_first(code: Code) -> bool:
    """Return whether destroy_node() is called above spin(); a lifecycle node is seen even so."""
    first = {name: code.calls[name][0] for name in ('destroy_node', 'spin') if name in code.calls}
    at = [(call.lineno, call.col_offset) for call in first.values()]
    return len(at) == 2 and at[0] < at[1]


def _creates_node(code: Code) -> bool:
    made = (name.endswith('Node') or name in ('__init__', 'create_node') for name in code.calls)
    return any(made)


_FACTS: Mapping[str, Callable[[Code], bool]] = {
    'catches_all': lambda code: code.catches_all,
    'ends_itself': lambda code: code.ends_itself,
    'loops': lambda code: code.loops,
    'serves': lambda code: 'spin' in code.calls or code.loops,
    'spins': lambda code: any(name.startswith('spin') for name in code.names),
    'creates_executor': lambda code: any(name.endswith('Executor') for name in code.calls),
    'overrides_activate': lambda code: (
        'on_activate' in code.functions and 'on_activate' not in code.calls
    ),
    'creates_node': _creates_node,
    'has_callbacks': _has_callbacks,
    'main_unused': _main_unused,
    'destroyed_first': _destroyed_first,
}
