"""
Lesson 10: a new Python package with a node, the speed limiter.

Specification from the lesson: package ``my_robot_pkg`` with the executable and node ``limiter``;
it publishes each ``std_msgs/msg/Float64`` of ``wanted_speed`` on ``speed``, limited to
``max_speed`` forwards and backwards.  The parameter ``max_speed`` is 1.0 by default and 0.5 in
``config/limiter.yaml``, and may change.  The node is started in a namespace, with that file.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.slips import (
    changing,
    in_force_slips,
    leaving_out,
    Limit,
    limiting_slips,
    within,
)
from autograder.exam.specification import each, Rule, Specification
from autograder.exam.steps import feeds, get_parameters, set_parameters
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_silent
from autograder.judging.checks import field_of
from autograder.judging.claims import node, one_for_one, passes
from autograder.judging.message_package import require_declarations
from autograder.judging.rows import published, require_all_sent, require_values

PACKAGE, NODE = 'my_robot_pkg', 'limiter'
TYPE = 'std_msgs/msg/Float64'
FILE = 'config/limiter.yaml'
DEFAULT, IN_FILE = 1.0, 0.5  # of max_speed [m/s]
EXERCISE = 'Exercise 1: a speed limiter'
DOUBLE = 3  # PARAMETER_DOUBLE in rcl_interfaces/msg/ParameterType
WHY = Causes(__file__, FILE=FILE, IN_FILE=IN_FILE)

DECLARATIONS = """
<depend>rclpy</depend>
depend|exec_depend
The node imports rclpy when it runs.

<depend>std_msgs</depend>
depend|exec_depend
Float64 is a type of std_msgs.
"""


class Wanted(NamedTuple):
    """A wanted speed, with max_speed at that moment and at the start [m/s]."""

    speed: float
    most: float
    start: float = IN_FILE


def limited(cut: Limit = within) -> Rule:
    """Return the rule of a program that limits each speed independently."""
    found = each(lambda one: cut(one.speed, one.most))
    return lambda inputs: [() if one is None else (one,) for one in found(inputs)]


SLIPS = (
    *leaving_out(limited(), lambda one: one.speed, numbers=True),
    *limiting_slips(limited, 'speed', 'most'),
    *changing(lambda change: limited(lambda speed, most: change(within(speed, most)))),
    # The node accepts every value of the parameter, so the slip ``keeps_refused`` is impossible.
    *in_force_slips(
        lambda most: each(lambda one: (within(one.speed, most(one)),)), 'max_speed', DEFAULT
    )[:2],
)


def declares_its_dependencies(run: Run) -> None:
    """package.xml names the package, its two dependencies and its build type."""
    require_declarations(run.files['package.xml'], PACKAGE, DECLARATIONS, 'ament_python')


def parameter(run: Run) -> tuple[int, float | None]:
    """Return the type of max_speed at the start, 0 if not set, and its value if it is a float."""
    answers = run.recording.answers(f'{run.facts["node"]}/get_parameters')
    kind = field_of(answers[0], 'values.0.type') if answers else 0
    value = field_of(answers[0], 'values.0.double_value') if kind == DOUBLE else None
    return kind or 0, value if isinstance(value, float) else None  # JSON has no NaN


def takes_the_file(run: Run) -> None:
    """The parameter max_speed has the value from config/limiter.yaml, 0.5."""
    kind, value = parameter(run)
    if value != IN_FILE:
        raise Failed(
            expected=f'max_speed {IN_FILE}',
            observed='no finite float in max_speed' if value is None else f'max_speed {value}',
            why=why_silent(run) or _why_other_value(run, kind, value),
        )


def _why_other_value(run: Run, kind: int, value: float | None) -> Cause | None:
    if kind == 0:
        return WHY['not_declared']
    if value is None:
        return None
    if value == DEFAULT and '/**' not in run.files.get(FILE, ''):
        return WHY['another_node']
    return WHY['value_in_the_file']


def _require_speeds(run: Run, first: bool) -> None:
    asked, number = run.asked('speeds'), run.facts['before']
    _, value = parameter(run)
    if value is not None:  # a different check compares the value with the file
        changed = [
            one._replace(most=value if place < number else one.most, start=value)
            for place, one in enumerate(asked.inputs)
        ]
        asked = replace(asked, inputs=changed)
    found = published(run, 'speeds', run.facts['target'])
    places = range(number) if first else range(number, len(found))
    require_values(run, asked, found, places, 'a speed of at most max_speed')
    require_all_sent(run, found)


def limits_the_speed(run: Run) -> None:
    """It publishes the wanted speed, at most max_speed forwards and backwards."""
    _require_speeds(run, first=True)


def follows_the_parameter(run: Run) -> None:
    """After a change of max_speed, the new value is the limit."""
    _require_speeds(run, first=False)


def build(
    space: str, before: Sequence[float], most: float, after: Sequence[float], burst: int = 0
) -> Exam:
    """
    Return the exam for some speeds.

    :param space: namespace in which the node is started, such as ``/lab``
    :param before: wanted speeds while max_speed has the value of the file [m/s]
    :param most: the value to which max_speed is then set [m/s]
    :param after: wanted speeds after this change [m/s]
    :param burst: number of speeds at the end that are sent at once
    """
    name, source, target = (f'{space}/{base}' for base in (NODE, 'wanted_speed', 'speed'))
    steps = (
        get_parameters(name, ['max_speed']),
        *feeds(source, [{'data': speed} for speed in before], 0),
        set_parameters(name, {'max_speed': most}),
        *feeds(source, [{'data': speed} for speed in after], burst),
    )
    wanted = [Wanted(one, IN_FILE) for one in before] + [Wanted(one, most) for one in after]
    exam = Exam(
        'limiter',
        title='A package with a speed limiter',
        assignment='10_package_of_your_own',
        part=1,
        cells=(
            *('limiter', 'limiter_package_xml', 'limiter_setup_py'),
            *('limiter_setup_cfg', 'limiter_yaml'),
        ),
        requires=('limiter.py', 'package.xml', 'setup.py', 'setup.cfg', FILE),
        scenario=Scenario(
            program='package',
            build_type=PACKAGE,
            file='limiter.py',
            arguments=('-r', f'__ns:={space}', '--params-file', f'{{share}}/{FILE}'),
            feed={source: TYPE},
            watch={target: TYPE},
            steps=steps,
        ),
        read=EXERCISE,
        facts={'node': name, 'target': target, 'before': len(before)},
        asks={'speeds': Specification(wanted, limited(), SLIPS, burst)},
    )
    exam.check(points=2, static=True)(declares_its_dependencies)
    exam.check(points=3, read='Part 2: Build and run')(
        node(
            name,
            sentence='The package builds, and ros2 run starts its node limiter.',
            only_named=True,
        )
    )
    exam.check(points=3, needs=['starts_its_node'])(
        passes(
            (source, TYPE),
            (target, TYPE),
            sentence='It subscribes to wanted_speed and publishes on speed, in any namespace.',
        )
    )
    exam.check(points=4, needs=['starts_its_node'], read='Part 3: Change it from outside')(
        takes_the_file
    )
    exam.check(points=1, needs=['reads_and_writes'])(
        one_for_one('speeds', target, sentence='It answers each message with exactly one message.')
    )
    exam.check(points=4, needs=['one_for_one'])(limits_the_speed)
    exam.check(points=3, needs=['limits_the_speed'])(follows_the_parameter)
    return exam


exam = build('/lab', (0.2, 0.7, 1.5, -0.3, -0.8, -2.0), 0.25, (0.4, -0.4, 0.1, 3.0))
