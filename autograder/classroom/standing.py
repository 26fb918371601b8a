"""
State how far the work of each student is, for all commands and pages that read results.

A mark counts only if it belongs to the work that is in ``submitted/`` now.  So every result has
the digest of the student's collected work when it was graded, which is compared with the work now.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
import hashlib

from autograder.classroom.collected import NOTHING, read_not_collected, Work
from autograder.classroom.people import class_list, read_people
from autograder.classroom.results_of_class import has_mark
from autograder.layout import Layout
from autograder.results import first_of, SubmissionResult
from autograder.submission.inbox import discover, student_id

GRADED = 'graded'
REVIEW = 'for review'
NO_GRADE = 'only visible checks were run'
BY_HAND = 'to be graded by hand'
NOT_ENTERED = 'not in the gradebook'
CHANGED = 'changed since the last grading'
UNGRADED = 'collected, but not graded yet'
NOT_COLLECTED = 'not collected'
MISSING = 'nothing handed in'

TO_GRADE = (CHANGED, UNGRADED)
WITHOUT_RESULT = (*TO_GRADE, NOT_COLLECTED, MISSING)
ADVICE = {
    **dict.fromkeys((*TO_GRADE, NOT_ENTERED), 'make grade'),
    BY_HAND: 'make lab, Nbgrader > Formgrader > Manual Grading; or --points automatic in exports',
}
"""What to do about a status, for those that an instructor can change."""
MAX_NAMED = 10


@dataclass(frozen=True)
class Standing:
    """
    The state of one student's work for an assignment.

    :param status: one of the strings above; only the gradebook knows about ``BY_HAND`` and
        ``NOT_ENTERED`` (see :mod:`autograder.exports.marks`)
    :param reason: why there is no score, as a sentence; empty if there is one
    :param person: the student's name, empty if it is not known
    :param result: the last result, of earlier work if the status is ``CHANGED``
    """

    student: str
    status: str
    reason: str = ''
    person: str = ''
    result: SubmissionResult | None = None


def standings(
    layout: Layout, assignment: str, results: Sequence[SubmissionResult]
) -> tuple[Standing, ...]:
    """
    Return the state of each student's work: in the order of the results, then the others.

    The others are those whose work was collected but not graded, those whose delivery could not be
    collected, and those on the class list who handed in nothing.

    :raises GraderError: if the class list is wrong, or the file of ``collect`` is damaged
    """
    now, people = collected_digests(layout, assignment), read_people(layout)
    found = []
    for result in results:
        status, reason = status_of(result), result.review
        before, after = result.collected, now.get(result.student)
        if None not in (before, after) and before != after:
            status, reason = CHANGED, 'Changed since the last grading.'
        name = people.get(result.student, '')
        found.append(Standing(result.student, status, reason, name, result))
    # The class list contains ids from collect, but the folder of a submission may be named with
    # the original name: accept both.
    there = {name for one in results for name in (one.student, student_id(one.student))}
    others = {
        name: Standing(name, UNGRADED, 'Collected, but not graded yet.', people.get(name, ''))
        for name in now.keys() - there
    }
    there.update(name for one in others for name in (one, student_id(one)))
    for work in read_not_collected(layout):
        if work.assignment in ('', assignment) and work.student not in there:
            status, name = (MISSING if work.why == NOTHING else NOT_COLLECTED), work.student
            others[name] = Standing(name, status, work.reason, people.get(name, work.person))
    for name in class_list(layout).keys() - there - others.keys():
        others[name] = Standing(name, MISSING, f'{NOTHING}.', people.get(name, ''))
    return (*found, *(others[name] for name in sorted(others)))


def without_result(
    layout: Layout, assignment: str, results: Sequence[SubmissionResult]
) -> tuple[Standing, ...]:
    """Return the students whose current work has no result; errors as for :func:`standings`."""
    found = standings(layout, assignment, results)
    return tuple(one for one in found if one.status in WITHOUT_RESULT)


def status_of(result: SubmissionResult) -> str:
    """Return the status of work that has not changed since it was graded."""
    return REVIEW if result.review else GRADED if has_mark(result) else NO_GRADE


def collected_digests(layout: Layout, assignment: str) -> dict[str, str]:
    """Return a digest of the work in ``submitted/`` for an assignment, by student."""
    found = {}
    try:
        notebook = layout.release(assignment).name
        class_ = discover(layout.submitted, assignment, notebook, layout.assignments())
    except OSError:  # There is no such folder.
        return {}
    for one in class_:
        data, problems = one.read(notebook)
        if data is None:
            data = repr(problems).encode('utf-8', 'backslashreplace')
        found[one.student] = hashlib.sha256(data).hexdigest()
    return found


def by_status(found: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield a line per status: the number of students, the first of them, and what to do."""
    students: dict[str, list[str]] = {}
    for student, status in found:
        students.setdefault(status, []).append(student)
    for status, names in students.items():
        advice = next((f'. Try: {ADVICE[one]}' for one in ADVICE if status.startswith(one)), '')
        yield f'{status} ({len(names)}): {first_of(names, MAX_NAMED)}{advice}'


def absent(missing: Iterable[Standing]) -> list[Standing]:
    """Return the students without usable work, not those whose work only waits for grading."""
    return [one for one in missing if one.status not in TO_GRADE]


def names_for_email(students: Iterable[Standing | Work]) -> str:
    """Return the names or ids of students, with commas, for an e-mail to them."""
    return ', '.join(dict.fromkeys(one.person or one.student for one in students))
