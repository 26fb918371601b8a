"""A small class for export tests: passed, failed, not run, for review, and hostile strings."""

from dataclasses import replace

from autograder.classroom.results_of_class import ClassResults
from autograder.classroom.standing import MISSING
from autograder.exports.marks import automatic, Mark
from autograder.results import CheckResult, ExamResult, Problem, SubmissionResult, Verdict

ASSIGNMENT = '01_talker'
FORMULA = '=HYPERLINK("http://127.0.0.1/?"&A1,"x")'
EVIL = '</failure>]]><script>&"\'\x00\x1b[31m\ufffe\ud800,\r\n;' + FORMULA
"""A string that no format may interpret: markup, control characters, a surrogate, a formula."""


def check(name, verdict=Verdict.PASSED, points=2.0, most=2.0, **more):
    return CheckResult(name, f'It {name}.', verdict, points, most, **more)


def failed(name='warns', words='a typo', **more):
    return check(
        name,
        Verdict.FAILED,
        0.0,
        3.0,
        **{'cause': words, 'cause_id': 'typo', 'expected': 'one', 'observed': 'none', **more},
    )


def submission(student='ann', checks=(), exam='talker', **more):
    waits = check('stops', Verdict.NOT_RUN, 0.0, 1.5, waits_for='warns')
    done = ExamResult(
        exam,
        tuple(checks) or (check('runs'), failed(), waits),
        'watched',
        'bwrap-user',
        ('odd',),
        {'run_s': 1.25, 'ready_s': 0.5, 'judge_s': 0.001},
        'abc.jsonl',
    )
    return SubmissionResult(student, ASSIGNMENT, (done,), **more)


FULL = submission('bob', (check('runs'), check('warns', points=3.0, most=3.0)))
VISIBLE = replace(FULL, exams=(replace(FULL.exams[0], mode='none'),))
"""A result without isolation of the hidden exams: only visible checks, and no mark."""
REVIEW = submission('eve', fault='The probe broke off. Grade it again.')
HOSTILE = submission(
    f'x{EVIL}'.replace('\ud800', ''),  # an id can always be encoded
    (check('runs'), failed(words=EVIL, observed=EVIL, expected=EVIL)),
    problems=(Problem(EVIL, EVIL, EVIL, EVIL, ('cell',)),),
    noticed=(EVIL,),
)
ABSENT = Mark('zoe', None, 6.5, MISSING, assignment=ASSIGNMENT)
CLASS = ClassResults(ASSIGNMENT, (submission(), FULL, REVIEW, HOSTILE))


def marked(graded=CLASS, *absent):
    """Return the marks of a class in the form that exports receive."""
    return [*map(automatic, graded.results), *absent]
