"""Take a lesson from release to returned feedback, with the requests that the buttons send."""

import re
from typing import Any

from autograder.layout import Layout
from autograder.submission.notebook import marks_of, read_release
from deploy.hub.user import run, User
from environment.places import PROJECT

LESSON, EXERCISE = '01_node_life', 'night_watch'
PASSED = f'{EXERCISE}: passed'
CHECK = f"print('{PASSED}' if check('{EXERCISE}') else 'failed')"


class LessonFailed(Exception):
    """Raised when a step does not do what its button promises."""


def teach(hub: str, instructor: str, student: str) -> str:
    """
    Release a lesson, solve one exercise as a student, grade it and return the feedback.

    The users must be new to the hub, or have the password in :mod:`deploy.hub.user`.

    :param hub: address of the hub, with a trailing slash
    :returns: the points on the student's feedback page
    :raises LessonFailed: if a step fails
    :raises requests.RequestException: if a server refuses a request
    """
    teacher, learner = User(hub, instructor), User(hub, student)
    for user in (teacher, learner):
        user.log_in()
    press(teacher, 'assignment', 'assign')
    press(teacher, 'assignment', 'release')
    fetched = choose(learner, 'fetch', 'fetched')
    expected = solve(learner, fetched['notebooks'][0]['path'])
    choose(learner, 'submit', 'submitted')
    press(teacher, 'assignment', 'collect')
    press(teacher, 'submission', f'{student}/autograde')
    press(teacher, 'assignment', 'generate_feedback')
    press(teacher, 'assignment', 'release_feedback')
    submission = choose(learner, 'fetch_feedback', 'submitted')['submissions'][-1]
    points = returned(learner, submission)
    if not points.startswith(f'{expected} of '):
        raise LessonFailed(f'{EXERCISE}: expected {expected} points in the feedback, got {points}')
    return points


def press(teacher: User, kind: str, action: str) -> None:
    """Press a button of the lesson in formgrader; ``kind`` is assignment or submission."""
    answer = teacher.ask('POST', f'formgrader/api/{kind}/{LESSON}/{action}')
    if not answer['success']:
        raise LessonFailed(f'{action}: {answer.get("log")}{answer.get("error")}')


def choose(learner: User, action: str, status: str) -> dict[str, Any]:
    """Press a button in the student's assignment list, and return the lesson's new row."""
    course = Layout(PROJECT).facts.name
    answer = learner.ask('POST', f'assignments/{action}', course_id=course, assignment_id=LESSON)
    for row in answer['value'] if answer['success'] else ():
        if (row['assignment_id'], row['status']) == (LESSON, status):
            return dict(row)
    raise LessonFailed(f'{action}: {answer}')


def solve(learner: User, path: str) -> int:
    """
    Type the solution into its cell, save the notebook, run the cell and check it.

    :param path: the fetched notebook on the student's server
    :returns: the points of the exercise
    """
    source = read_release(next((PROJECT / 'solutions' / LESSON).glob('*.ipynb')))
    notebook = learner.ask('GET', f'api/contents/{path}')['content']
    answer = cell_of(notebook, EXERCISE)
    answer['source'] = cell_of(source, EXERCISE)['source']
    learner.ask('PUT', f'api/contents/{path}', type='notebook', content=notebook)
    first = next(cell for cell in notebook['cells'] if cell['cell_type'] == 'code')
    kernel = learner.kernel(path.rpartition('/')[0])
    for code in (first['source'], answer['source']):
        run(kernel, code)
    printed = run(kernel, CHECK)
    kernel.close()
    if PASSED not in printed:
        raise LessonFailed(f'check({EXERCISE!r}): {printed}')
    return int(marks_of(cell_of(notebook, f'check_{EXERCISE}'))['points'])


def cell_of(notebook: dict[str, Any], grade_id: str) -> dict[str, Any]:
    """Return a cell of a notebook by its grade id."""
    return next(cell for cell in notebook['cells'] if marks_of(cell).get('grade_id') == grade_id)


def returned(learner: User, submission: dict[str, Any]) -> str:
    """Return the points on the feedback page of a submission."""
    folder = submission['local_feedback_path']
    if not folder:
        raise LessonFailed(f'fetch_feedback: no page in {submission}')
    page, *_ = learner.ask('GET', f'api/contents/{folder}')['content']
    text = learner.ask('GET', f'api/contents/{page["path"]}')['content']
    points = re.search(r'<h1>.*: (.* points)</h1>', text)
    if not points:
        raise LessonFailed(f'{page["path"]}: no points on this page')
    return points[1]
