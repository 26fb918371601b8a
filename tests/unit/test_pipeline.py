"""Grade a class in parallel: each submission gets its own result, whatever others do."""

import json
from pathlib import Path
import threading

from fake_grading import answer, FakeEngine, FakeExam
import pytest

from autograder.errors import GraderError
from autograder.explaining.feedback import headline
from autograder.grading.pipeline import grade_class, grade_opened, Lesson, open_one
from autograder.submission.inbox import Submission

RELEASE = {'cells': [answer('# YOUR CODE HERE')], 'metadata': {}}
LESSON = Lesson('01', 'talker.ipynb', RELEASE, (FakeExam('first'), FakeExam('second')))


def handed_in(student, word):
    """Return a submission whose answer is one word."""
    return Submission(student, Path('x'), json.dumps({'cells': [answer(word)]}).encode())


def points(graded):
    return {one.result.student: None if one.result.fault else one.result.points for one in graded}


def test_results_come_in_the_order_of_the_submissions():
    class_ = [handed_in(f's{number}', 'right') for number in range(20)]

    graded = grade_class(class_, LESSON, FakeEngine(), jobs=4)

    assert [one.result.student for one in graded] == [one.student for one in class_]
    assert set(points(graded).values()) == {2.0}


@pytest.mark.parametrize('word', ['probe', 'bug'])
def test_our_own_fault_is_for_review_and_stops_nobody(word):
    class_ = [handed_in('ann', 'right'), handed_in('bob', word), handed_in('cho', 'wrong')]

    graded = grade_class(class_, LESSON, FakeEngine(), jobs=2)

    assert points(graded) == {'ann': 2.0, 'bob': None, 'cho': 0.0}
    assert graded[1].result.fault


def test_a_broken_file_is_zero_with_the_reason():
    class_ = [Submission('ann', Path('x'), b'nonsense'), handed_in('bob', 'right')]

    graded = grade_class(class_, LESSON, FakeEngine(), jobs=2)

    assert points(graded) == {'ann': 0.0, 'bob': 2.0}
    assert 'not JSON' in headline(graded[0].result)


def test_progress_is_reported_for_each_exam_of_each_student():
    done = []
    class_ = [handed_in('ann', 'right'), handed_in('bob', 'right'), handed_in('cho', 'bug')]

    grade_class(class_, LESSON, FakeEngine(), jobs=2, on_done=lambda *one: done.append(one))

    assert sorted(student for student, _ in done) == ['ann', 'ann', 'bob', 'bob', 'cho', 'cho']
    assert {student for student, one in done if isinstance(one, GraderError)} == {'cho'}


def test_each_result_is_reported_in_the_calling_thread_while_another_runs_the_rest():
    done, where = [], set()
    hold = threading.Event()

    class Running(FakeEngine):
        def run(self, exam, files):
            assert 'last' not in ''.join(files.values()) or hold.wait(30)
            return super().run(exam, files)

    def on_graded(graded):
        assert graded.result.exams
        done.append(graded.result.student)
        where.add(threading.current_thread())
        if done == ['s1', 's2']:
            hold.set()

    class_ = [handed_in(f's{n}', f'right {n}') for n in (1, 2)]
    class_ += [handed_in('s3', 'right last')]
    engine = Running()
    graded = grade_class(class_, LESSON, engine, jobs=1, on_graded=on_graded)

    assert len(engine.threads) == 1
    assert done == ['s1', 's2', 's3']
    assert where == {threading.main_thread()}
    assert set(points(graded).values()) == {2.0}


def test_ctrl_c_starts_nothing_new():
    engine, begun, held = FakeEngine(), threading.Event(), threading.Event()
    run, ran = engine.run, []

    def wait_then_run(exam, files):
        (text,) = files.values()
        ran.append(text)
        if 'first' not in text:
            begun.set()
            held.wait(10)
        return run(exam, files)

    def interrupt(graded):
        begun.wait(10)
        raise KeyboardInterrupt

    engine.run = wait_then_run
    class_ = [handed_in('a', 'right first')]
    class_ += [handed_in(f's{number}', f'right {number}') for number in range(50)]

    with pytest.raises(KeyboardInterrupt):
        grade_class(class_, LESSON, engine, jobs=1, on_graded=interrupt)
    held.set()

    assert len(ran) <= 4


def test_one_notebook_is_graded_the_same_way():
    opened = open_one(handed_in('ann', 'right'), LESSON)
    result = grade_opened(opened, 'ann', LESSON, FakeEngine())

    assert (result.student, result.points, result.max_points) == ('ann', 2.0, 2)
