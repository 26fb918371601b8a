"""
nbgrader's settings for this course, which every nbgrader command and formgrader read.

Student code never runs in nbgrader's process: see autograder/gradebook/nbgrader_plugin.py.
"""

from importlib.util import find_spec
import os
from pathlib import Path
import sys
import warnings

from autograder.layout import Layout
from environment.exchange import exchange_root, protect

c = get_config()  # defined by nbgrader

root = Path(__file__).resolve().parent
course = Layout(root)
work = course.facts.work

c.CourseDirectory.root = str(root)
c.CourseDirectory.course_id = course.facts.name
c.CourseDirectory.source_directory = 'solutions'
c.CourseDirectory.release_directory = 'notebooks'
c.CourseDirectory.submitted_directory = f'{work}/submitted'
c.CourseDirectory.autograded_directory = f'{work}/autograded'
c.CourseDirectory.feedback_directory = f'{work}/feedback'
c.CourseDirectory.solution_directory = f'{work}/solution'
c.CourseDirectory.source_with_tests_directory = f'{work}/source_with_tests'
c.CourseDirectory.db_url = f'sqlite:///{course.work}/gradebook.db'
# A learner's built workspace is next to the notebook and is not part of the assignment.
c.CourseDirectory.ignore = ['.ipynb_checkpoints', '*.pyc', '__pycache__', 'feedback', 'ros_ws']

# nbgrader creates a new gradebook with the command alembic, which is next to this Python.
folders, beside = os.environ.get('PATH', '').split(os.pathsep), str(Path(sys.prefix) / 'bin')
if folders[0] != beside:  # nbgrader may read this file more than once
    os.environ['PATH'] = os.pathsep.join([beside, *folders])

# SQLite and the exchange need their folders. COURSE_EXCHANGE names a different exchange, for
# students who share this machine: docs/exchange.md.
for folder in ('exchange', 'submitted'):
    (course.work / folder).mkdir(parents=True, exist_ok=True)
exchange = exchange_root(root, os.environ)
protect(exchange)
c.Exchange.root = str(exchange)
c.ExchangeFactory.release_assignment = 'autograder.collect.exchange_plugin.ReleaseProtected'
c.ExchangeFactory.collect = 'autograder.collect.exchange_plugin.CollectFromOwners'
c.KernelManager.transport = 'ipc'

c.GenerateAssignment.preprocessors = [
    'nbgrader.preprocessors.LockCells',
    'autograder.gradebook.nbgrader_plugin.ClearSolutionsByKind',
    'nbgrader.preprocessors.ClearOutput',
    'nbgrader.preprocessors.CheckCellMetadata',
    'nbgrader.preprocessors.ComputeChecksums',
    'nbgrader.preprocessors.SaveCells',
    'nbgrader.preprocessors.ClearHiddenTests',
    'nbgrader.preprocessors.ClearMarkScheme',
    'nbgrader.preprocessors.ComputeChecksums',
    'nbgrader.preprocessors.CheckCellMetadata',
    'autograder.authoring.lesson_frame.AddFrame',
]

c.Autograde.exporter_class = 'autograder.gradebook.nbgrader_plugin.SubmissionExporter'
c.Autograde.autograde_preprocessors = [
    'autograder.gradebook.nbgrader_plugin.GradeOutside',
    'nbgrader.preprocessors.LimitOutput',
    'autograder.gradebook.nbgrader_plugin.SaveGrades',
    'nbgrader.preprocessors.AssignLatePenalties',
    'nbgrader.preprocessors.CheckCellMetadata',
]

# SQLAlchemy warns about nbgrader's own queries, whose results are correct.
warnings.filterwarnings('ignore', message='Object of type .* not in session')

# Feedback and formgrader show students' Markdown to instructors.
c.HTMLExporter.sanitize_html = True
c.HTMLExporter.filters = {
    'markdown2html': 'autograder.gradebook.nbgrader_plugin.safe_markdown',
    'clean_html': 'autograder.gradebook.nbgrader_plugin.safe_output',
}
# The course's own page for students loads nothing from elsewhere and supports dark mode.
# HTMLExporter itself is unchanged, because formgrader uses it with a separate template.
c.GenerateFeedback.exporter_class = 'autograder.gradebook.nbgrader_plugin.FeedbackExporter'
# Marks can change without a new submission: by hand, after an appeal, or with an edited exam.
c.GenerateFeedback.force = True
c.GenerateFeedback.preprocessors = [
    'autograder.gradebook.nbgrader_plugin.GradesToShow',
    'nbconvert.preprocessors.CSSHTMLHeaderPreprocessor',
]
c.FeedbackExporter.template_name = 'feedback_page'
c.FeedbackExporter.extra_template_basedirs = [
    str(Path(find_spec('autograder').origin).parent / 'templates')
]

# Settings of this class, such as the late policy: docs/gradebook.md. The file may be missing.
load_subconfig('nbgrader_config.py', path=str(course.work))
