"""Follow the page for instructors literally, in a new course."""

import json
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / 'docs' / 'writing-an-exam.md').read_text(encoding='utf-8')
BLOCKS = re.findall(r'^`([^`\n]+)`\n```\w+\n(.*?)^```$', PAGE, re.MULTILINE | re.DOTALL)
COMMANDS = [
    line
    for block in re.findall(r'^```sh\n(.*?)^```$', PAGE, re.MULTILINE | re.DOTALL)
    for line in block.splitlines()
]
SAMPLES = Path('tests', 'submissions', '20_doors')


@pytest.fixture(scope='module')
def course(tmp_path_factory) -> Path:
    """Return a course with only the exercise of the page."""
    root = tmp_path_factory.mktemp('new') / 'doors'
    begin, exercise = COMMANDS[:2]
    done = follow(ROOT, begin.replace('../doors', str(root)).replace('.venv', sys.prefix))
    assert done.returncode == 0, done.stderr
    # Use the environment of this project, which has the messages, instead of a new set-up.
    (root / '.venv').symlink_to(sys.prefix)
    done = follow(root, exercise)
    assert done.returncode == 0, done.stderr
    path = root / 'solutions' / '20_doors' / 'doors.ipynb'
    notebook = json.loads(path.read_text(encoding='utf-8'))
    cells = {cell['id']: cell for cell in notebook['cells']}
    for where, text in BLOCKS:
        kind, _, name = where.partition(' ')
        if kind == 'cell':
            cells[name.replace('_', '-')]['source'] = text.rstrip('\n')
        else:
            (root / where).parent.mkdir(parents=True, exist_ok=True)
            (root / where).write_text(text, encoding='utf-8')
    path.write_text(json.dumps(notebook), encoding='utf-8')
    return root


@pytest.fixture(scope='module')
def released(course, tmp_path_factory) -> Path:
    """Return a copy of the course with its release; tests change copies of it."""
    root = tmp_path_factory.mktemp('released') / 'doors'
    shutil.copytree(course, root, symlinks=True)
    assert follow(root, COMMANDS[2]).returncode == 0
    return root


def follow(course: Path, line: str) -> subprocess.CompletedProcess[str]:
    """Run a line of the page, exactly as written, in a shell where ROS is not sourced."""
    kept = ('HOME', 'PATH', 'TMPDIR', 'COURSE_SECRET')
    return subprocess.run(
        line,
        shell=True,
        cwd=course,
        env={name: os.environ[name] for name in kept if name in os.environ},
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_the_exercise_has_fewer_than_sixty_lines_of_code():
    """Three cells, both exams and a sample are counted, without blank lines."""
    code = [text for where, text in BLOCKS if not where.endswith(('.json', 'text'))]
    lines = [line for text in code for line in text.splitlines() if line.strip()]

    assert len(code) == 6
    assert len(lines) < 60


def test_the_cells_import_what_they_call():
    """``check`` is not a builtin, so without the first cell the learner gets a NameError."""
    cells = {where.removeprefix('cell').strip(): text for where, text in BLOCKS if 'cell' in where}
    known: dict[str, object] = {}
    exec(cells['start'], known)

    assert set(compile(cells['check_visitor_counter'], '', 'exec').co_names) <= known.keys()


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
def test_following_it_literally_works(course):
    """The release is made, the self-check passes, and the sample fails with its expected cause."""
    release, proof, look, _ = COMMANDS[2:]

    done = follow(course, release)
    assert done.returncode == 0, done.stderr
    stub = json.loads((course / 'notebooks/20_doors/doors.ipynb').read_text(encoding='utf-8'))
    assert 'was_open = message.data' not in json.dumps(stub)

    done = follow(course, proof)
    assert done.stdout.splitlines() == [
        '20_doors: the reference solution has 6 of 6, as expected.',
        '20_doors: the untouched release has 0 of 6, as expected.',
    ], done.stderr

    done = follow(course, look)
    assert 'The visitor counter (visitor_counter): 2 of 6 points' in done.stdout, done.stderr
    assert 'A door that stays open counts again.' in done.stdout
    assert 'Count the visitors' in done.stdout
    assert '/visitors: data: ' in done.stderr


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
def test_misspelt_topic_is_explained_as_in_the_exams_of_the_course(course, tmp_path):
    """The check on the page contains no code for this cause."""
    sample = course / SAMPLES / 'fail__counts_messages' / 'visitor_counter.py'
    text = sample.read_text(encoding='utf-8')
    (tmp_path / 'visitor_counter.py').write_text(text.replace("'visitors'", "'visitor'"))
    look = COMMANDS[4].replace(str(sample.relative_to(course)), f'{tmp_path}/visitor_counter.py')

    said = ' '.join(follow(course, look).stdout.split())

    assert 'Your publisher uses the topic /visitor; did you mean /visitors?' in said
    assert "Give create_publisher() the name 'visitors'." in said


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
def test_the_samples_are_graded_once_there_are_three_right_ones(released, tmp_path):
    """One correct answer is too few, three are enough; this course itself requires twelve."""
    root = tmp_path / 'doors'
    shutil.copytree(released, root, symlinks=True)
    answer = next(text for where, text in BLOCKS if where == 'cell visitor_counter')
    expected = re.search(r'`("points":\s\{"visitor_counter": 6\}, "failed": \{\})`', PAGE)[1]
    said = []
    for style in ('one', 'two', 'three'):
        folder = root / SAMPLES / f'pass__{style}'
        folder.mkdir()
        text = f'{answer}# style {style}\n'.partition('\n')[2]
        (folder / 'visitor_counter.py').write_text(text, encoding='utf-8')
        (folder / 'expected.json').write_text(f'{{{expected}}}', encoding='utf-8')
        if style != 'two':
            line = COMMANDS[-1].replace('../ros2-course', str(ROOT)).replace('../doors', str(root))
            said.append(follow(root, line.replace('.venv', sys.prefix)))

    assert 'test_the_class_is_large_enough[20_doors]' in said[0].stdout, said[0].stdout
    assert ' 6 passed' in said[1].stdout, said[1].stdout + said[1].stderr
    assert said[1].returncode == 0


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ('wrong', 'right', 'said'),
    [
        ("Feed('/door_open'", "Feed('/door'", "did you mean '/door_open'?"),
        ('std_msgs/msg/Int32', 'std_msgs/msg/Int', 'std_msgs/msg/Int is not installed'),
        ("[{'data': door}", "[{'date': door}", "'Bool' object has no attribute 'date'"),
        ("{'data': door}", "{'data': 'yes'}", "The 'data' field must be of type 'bool'"),
        (
            "read='Count the visitors'",
            "read='Count the visitor'",
            "got 'Count the visitor'; did you mean 'Count the visitors'?",
        ),
        ('points=4, ', 'points=0, ', 'check publishes_visitors: expected points > 0'),
        ("needs=['one_", "needs=['on_", "needs 'on_for_one', which is not an earlier check"),
        ('= build((True', '= biuld((True', 'exams/visible/visitor_counter.py, line 30: NameError'),
        ('or not before)', 'or before)', 'visitor_counter/publishes_visitors: FAILED'),
    ],
)
def test_a_mistake_in_it_is_refused_with_its_place(released, tmp_path, wrong, right, said):
    """The self-check finds it before grading; in the last case, the reference fails a check."""
    root = tmp_path / 'course'
    shutil.copytree(released, root, symlinks=True)
    path = root / 'exams' / 'visible' / 'visitor_counter.py'
    text = path.read_text(encoding='utf-8')
    assert wrong in text
    path.write_text(text.replace(wrong, right), encoding='utf-8')

    done = follow(root, COMMANDS[3])

    assert done.returncode != 0
    assert said in done.stdout + done.stderr
