"""Find the exception that ended a program, and the learner's line, in the printed traceback."""

from handmade_runs import graph, run_of
import pytest

from autograder.judging.causes.ended import why_it_ended
from autograder.judging.causes.tracebacks import traceback_of

HEAD = 'Traceback (most recent call last):\n'
CODE = """def main():
    try:
        node = Talker()
        rclpy.spin(node)
    finally:
        node.destroy_node()
sys.exit(main())
"""


def part(error, line=3):
    return f'{HEAD}  File "/submission/talker.py", line {line}, in main\n    x\n    ^^^\n{error}\n'


def ended(stderr, code=CODE):
    """Return a run whose program printed something and failed."""
    seen = graph(nodes=['/talker'])
    return run_of(
        seen, code=code, file='talker.py', reason='student_exited', exit=1, stderr=stderr
    )


@pytest.mark.parametrize(
    'error',
    ['Exception: unknown unit', 'Exception', '__main__.SensorFault: 3', 'KeyboardInterrupt'],
)
def test_an_exception_of_any_name_is_seen(error):
    trace = traceback_of(ended(part(error)))

    assert trace.error == error
    assert (trace.line, trace.code) == (3, 'node = Talker()')


def test_the_usual_last_line_is_no_exit_of_the_program():
    """Every package contains sys.exit(main()), but the cause is the exception in main()."""
    raised = why_it_ended(ended(part('Exception: unknown unit')))
    silent = why_it_ended(ended(''))
    exits = why_it_ended(ended('', CODE.replace('main())', '1)')))

    assert raised.cause_id == 'exception'
    assert raised.line == 3
    assert silent.cause_id == 'died'
    assert exits.cause_id == 'ends_itself'


DIRECT = 'The above exception was the direct cause of the following exception:'
DURING = 'During handling of the above exception, another exception occurred:'


@pytest.mark.parametrize(
    ('between', 'last', 'line'),
    [
        # The program caught the earlier exception.
        (DIRECT, 'Exception: bad', 4),
        (DURING, 'Exception: bad', 4),
        # Because of the first exception, the node that the program destroys does not exist.
        (
            DURING,
            "UnboundLocalError: cannot access local variable 'node' where it is not associated "
            'with a value',
            6,
        ),
        (DURING, "UnboundLocalError: local variable 'node' referenced before assignment", 6),
        (DURING, "NameError: name 'node' is not defined", 6),
    ],
)
def test_of_chained_exceptions_the_last_counts_except_for_one_while_cleaning_up(
    between, last, line
):
    first = 'TypeError: no name'
    stderr = f'{part(first)}\n{between}\n\n{part(last, line)}'

    trace = traceback_of(ended(stderr))

    assert (trace.error, trace.line) == ((first, 3) if line == 6 else (last, line))


def test_an_exception_that_python_ignores_ended_nothing():
    """Python prints exceptions from destructors below the exception that ended the program."""
    ignored = 'Exception ignored in: <function Destroyable.__del__ at 0x7f>\n'
    after = part("AttributeError: 'NoneType' object has no attribute 'x'", 6)

    assert (
        traceback_of(ended(part('ValueError: bad') + ignored + after)).error == 'ValueError: bad'
    )
    assert traceback_of(ended(ignored + after)) is None


def test_further_lines_of_a_message_are_no_error():
    """pybind11 lists signatures below its TypeError."""
    stderr = part('TypeError: log(): incompatible') + '    1. (x: int)\n\nInvoked with: Error, 1\n'

    assert traceback_of(ended(stderr)).error == 'TypeError: log(): incompatible'


def test_error_that_lost_its_frames_is_seen_all_the_same():
    trace = traceback_of(ended('    x\nValueError: bad\n'))

    assert (trace.error, trace.line, trace.place) == ('ValueError: bad', None, None)
    assert traceback_of(ended('[INFO] all is well\n')) is None


def test_suggestion_behind_a_path_is_kept():
    said = "ImportError: cannot import name 'Nod' from 'rclpy.node'"
    trace = traceback_of(ended(part(f"{said} (/usr/rclpy/node.py). Did you mean: 'Node'?")))

    assert trace.error == f"{said}. Did you mean: 'Node'?"


@pytest.mark.parametrize(
    ('library', 'module'),
    [
        ('/venv/lib/python3.12/site-packages/rclpy/node.py', 'node.py'),
        ('/usr/lib/python3.12/importlib/__init__.py', '__init__.py'),
    ],
)
def test_a_library_is_no_module_of_the_same_name(library, module):
    """A package has an __init__.py and may have a node.py, and so do Python and rclpy."""
    own = f'/tmp/ws/install/lib/python3.12/site-packages/my_talker/{module}'
    places = ((own, 2), (library, 900))
    frames = ''.join(f'  File "{path}", line {line}, in f\n    x\n' for path, line in places)
    run = ended(f'{HEAD}{frames}TypeError: no\n')
    run.files[f'my_talker/{module}'] = 'import x\nx.f()\n'

    trace = traceback_of(run)

    assert (trace.line, trace.code) == (2, 'x.f()')
