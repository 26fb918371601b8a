"""Malicious folders, file names and student names."""

import json
import os
import socket
import stat

from tests.attacks.notebook_builder import ASSIGNMENT, attack, lay_out, NOTEBOOK, PAYLOAD

REGULAR = 'only regular files are opened'
NO_LINK = 'only regular files are opened, and no link is followed'
STUDENT_ID = 'a student id has letters, digits and . _ - @; others are reported and not recorded'


@attack("only the notebook's own file is read", 0)
def brings_settings_and_modules(student, solved, blank):
    """Add settings, plug-ins and modules that a tool might load from the notebook's folder."""
    place = lay_out(student, blank)
    text = f'open({str(PAYLOAD)!r}, "w"); c = get_config(); c.SaveGrades.enabled = False'
    for name in (
        'nbgrader_config.py',
        'conftest.py',
        'sitecustomize.py',
        'autograder.py',
        'rclpy.py',
    ):
        (place / name).write_text(text)
    (place / 'gradebook.db').write_bytes(b'SQLite format 3\x00')
    (place / 'feedback').mkdir()
    (place / '.ipynb_checkpoints').mkdir()


@attack(REGULAR, 0, 'something else')
def hands_in_a_device(student, solved, blank):
    """Hand in an endless device, or a socket if only root may create devices."""
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    try:
        os.mknod(place / NOTEBOOK, 0o644 | stat.S_IFCHR, os.makedev(1, 5))
    except OSError:
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(f'/proc/self/fd/{os.open(place, os.O_RDONLY)}/{NOTEBOOK}')


@attack(REGULAR, 0, 'something else')
def hands_in_a_folder(student, solved, blank):
    """Hand in a folder with the name of the notebook."""
    (student / ASSIGNMENT / NOTEBOOK / NOTEBOOK).mkdir(parents=True)


@attack(REGULAR, 0, 'something else')
def hands_in_a_pipe(student, solved, blank):
    """Hand in a pipe, from which the grader would read forever."""
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    os.mkfifo(place / NOTEBOOK)
    os.mkfifo(place / 'timestamp.txt')


@attack('only the name of the folder identifies the student', 0)
def hands_in_the_names_of_others(student, solved, blank):
    """Write other students' names and grades wherever a grader might read a name."""
    blank['metadata'].update(student='ada', authors=[{'name': 'ada'}])
    for one in blank['cells']:
        one['metadata'].setdefault('nbgrader', {})['student'] = 'ada'
    place = lay_out(student, blank)
    (place / 'ada.ipynb').write_text(json.dumps(blank))
    (place / 'gradebook.csv').write_text('student,score\nada,0\n')


@attack('an invalid time is ignored', 50)
def has_a_hostile_timestamp(student, solved, blank):
    """Hand in with a submission time that no program can parse."""
    place = lay_out(student, solved)
    (place / 'timestamp.txt').write_text('999999999999-99-99 ' + '9' * 100_000)


@attack(
    'the grader never runs file names; it quotes and shortens them when it prints them',
    50,
    'which was graded instead',
)
def has_a_strange_file_name(student, solved, blank):
    """Give the file a name that a shell, a glob pattern or a log would interpret."""
    lay_out(student, solved, '-rf $(touch an-attack) *;\n\x1b[2J<b>.ipynb')


@attack('only real folders are entered', 0, 'a link or a file')
def links_its_folder(student, solved, blank):
    """Hand in a link to another student's folder."""
    student.mkdir()
    os.symlink(f'../ada/{ASSIGNMENT}', student / ASSIGNMENT)


@attack(NO_LINK, 0, 'a symbolic link')
def links_to_a_secret(student, solved, blank):
    """Hand in a symbolic link to a file that the grader may read."""
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    os.symlink('/etc/passwd', place / NOTEBOOK)
    os.symlink('/etc/shadow', place / 'timestamp.txt')


@attack(NO_LINK, 0, 'a symbolic link')
def links_to_another_submission(student, solved, blank):
    """Hand in a symbolic link to another student's notebook."""
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    os.symlink(f'../../ada/{ASSIGNMENT}/{NOTEBOOK}', place / NOTEBOOK)


@attack(STUDENT_ID, 0, 'expected a student id')
def bytes_as_name(student, solved, blank):
    """Hand in under a name whose bytes are not valid text."""
    lay_out(student.with_name('\udcff\udcfeada'), solved)


@attack(STUDENT_ID, 0, 'expected a student id')
def formula_as_name(student, solved, blank):
    """Hand in under a name that is a spreadsheet formula."""
    lay_out(student.with_name("=cmd|' -C calc'!A0"), solved)


@attack(STUDENT_ID, 0, 'expected a student id')
def markup_as_name(student, solved, blank):
    """Hand in under a name that consists of markup."""
    lay_out(student.with_name('<img src=x onerror=alert(1)>'), solved)


@attack(STUDENT_ID, 0, 'expected a student id')
def pattern_as_name(student, solved, blank):
    """Hand in under a name of patterns, commas and format fields, which nbgrader expands."""
    lay_out(student.with_name('*,{assignment_id}'), solved)


@attack(STUDENT_ID, 0, 'expected a student id')
def terminal_codes_as_name(student, solved, blank):
    """Hand in under a name that contains terminal codes and line breaks."""
    lay_out(student.with_name('\x1b[2Jred\nada,40'), solved)
