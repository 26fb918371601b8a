"""The state of each student's work: a mark counts only for the work that was graded."""

from dataclasses import replace

from collect_sources import GOOD, laid, LISTEN, TALK
from export_world import REVIEW as FAULTY
from export_world import submission, VISIBLE

from autograder.classroom import standing
from autograder.classroom.collected import save_collected, Work
from autograder.classroom.people import class_list
from autograder.classroom.results_of_class import ClassResults
from autograder.classroom.standing import by_status, collected_digests, standings, without_result
from autograder.classroom.statistics import class_numbers
from autograder.commands.stats import stats_text
from autograder.exports.marks import AUTOMATIC, marks
from autograder.results import SubmissionResult

FILE = f'{{}}/{TALK}/talk.ipynb'


def handed_in(layout, **files: bytes) -> None:
    laid(layout.submitted, {FILE.format(name): data for name, data in files.items()})


def results_of_now(layout, *results: SubmissionResult) -> list[SubmissionResult]:
    now = collected_digests(layout, TALK)
    return [replace(one, collected=now.get(one.student, '')) for one in results]


def states(layout, results) -> dict[str, str]:
    return {one.student: one.status for one in standings(layout, TALK, results)}


def test_every_student_has_one_state(layout):
    """A student who is on no list but has collected work is not forgotten."""
    handed_in(layout, ann=GOOD, bob=GOOD, eve=GOOD, odd=GOOD, new=GOOD)
    laid(layout.work, {'class_list.csv': b'student\nann\nnew\npdf\nzoe\n'})
    save_collected(layout, [Work('pdf', TALK, why='no notebook'), Work('new', LISTEN, why='no')])
    weak = replace(VISIBLE, student='odd')
    results = results_of_now(layout, submission('ann'), submission('bob'), FAULTY, weak)
    handed_in(layout, bob=GOOD + b' ')

    assert class_list(layout).keys() >= {'zoe'}
    assert states(layout, results) == {
        'ann': standing.GRADED,
        'bob': standing.CHANGED,
        'eve': standing.REVIEW,
        'odd': standing.NO_GRADE,
        'new': standing.UNGRADED,
        'pdf': standing.NOT_COLLECTED,
        'zoe': standing.MISSING,
    }
    missing = without_result(layout, TALK, results)
    assert [one.student for one in missing] == ['bob', 'new', 'pdf', 'zoe']


def test_work_has_changed_if_it_is_collected_later_or_replaces_what_could_not_be_read(layout):
    """Results of earlier versions, and work that is no longer there, keep their marks."""
    handed_in(layout, cut=b'')
    laid(layout.submitted, {f'empty/{TALK}/notes.txt': b'', f'empty/{TALK}/a/b.ipynb': GOOD})
    names = ('ann', 'cut', 'empty', 'gone', 'old')
    results = results_of_now(layout, *map(submission, names))
    results[3:] = replace(results[3], collected='1' * 64), replace(results[4], collected=None)
    handed_in(layout, ann=GOOD, cut=GOOD, empty=GOOD, old=GOOD)

    found = states(layout, results)

    assert [one for one, state in found.items() if state == standing.CHANGED] == [
        'ann',
        'cut',
        'empty',
    ]
    assert found['gone'] == found['old'] == standing.GRADED


def test_changed_work_has_no_mark_and_statistics_name_it(layout):
    handed_in(layout, ann=GOOD, bob=GOOD)
    here = ClassResults(TALK, tuple(results_of_now(layout, submission('ann'), submission('bob'))))
    handed_in(layout, bob=GOOD + b' ', new=GOOD)

    found = marks(layout, here, AUTOMATIC)
    text = stats_text(class_numbers(layout, here), ['ann', 'bob'])

    assert [(one.student, one.points, one.result is None) for one in found] == [
        ('ann', 2.0, False),
        ('bob', None, True),
        ('new', None, True),
    ]
    assert '  changed since the last grading (1): bob. Try: make grade\n' in text
    assert '  collected, but not graded yet (1): new. Try: make grade\n' in text
    assert '  to be graded by hand (1): ann. Try: make lab' in text
    assert 'Nothing handed in' not in text


def test_many_students_with_one_status_make_one_line():
    (line,) = by_status((str(number), standing.BY_HAND) for number in range(52))

    assert line.startswith('to be graded by hand (52): 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 42 more.')
    assert '--points automatic' in line
