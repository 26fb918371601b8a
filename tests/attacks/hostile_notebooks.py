"""Malicious notebooks."""

import base64
import json
import os
import pickle

from tests.attacks.notebook_builder import attack, cell, checks, code, marked, PAYLOAD

REBUILT = 'the notebook is rebuilt from the release; only the source of answers survives'
NAMED_FILE = 'each answer must be the file that the release names'
IN_WORDS = 'a readable error'


@attack(REBUILT, 0, "is a 'raw' cell")
def changes_cell_types(student, solved, blank):
    """Turn every cell that nbgrader knows into a raw cell."""
    for one in marked(blank):
        one['cell_type'] = 'raw'
    return blank


@attack('no kernel is started; the metadata are those of the release', 0)
def chooses_its_kernel(student, solved, blank):
    """Name a separate kernel, with a command that starts it."""
    blank['metadata'] = {
        'kernelspec': {
            'name': '../../evil',
            'display_name': 'evil',
            'argv': ['touch', str(PAYLOAD)],
        },
        'language_info': {'name': 'sh', 'nbconvert_exporter': 'script', 'file_extension': '.sh'},
        'celltoolbar': 'Create Assignment',
    }
    return blank


@attack(REBUILT, 0, 'is missing')
def deletes_the_checks(student, solved, blank):
    """Hand in a notebook without the check cells, so that nothing can fail."""
    gone = list(checks(blank))
    blank['cells'] = [one for one in blank['cells'] if one not in gone]
    return blank


@attack('the first one counts, and a flag reports the others', 35, 'occurs 2 times')
def duplicates_an_answer(student, solved, blank):
    """Hand in several answers to one question, so that the best one might count."""
    right = cell(solved, 'temperature_publisher')
    wrong = {**right, 'id': 'first', 'source': '%%node temp_publisher\n'}
    solved['cells'].insert(0, wrong)
    return solved


@attack(REBUILT, 0, 'occurs 4 times')
def duplicates_the_checks(student, solved, blank):
    """Hand in every check several times."""
    blank['cells'] += [dict(one) for one in checks(blank) for _ in range(3)]
    return blank


@attack('expat limits the expansion of entities; external entities are not read', 45)
def expands_entities(student, solved, blank):
    """Fill the memory of the program that reads package.xml, with nested entities."""
    laughs = ''.join(f'<!ENTITY l{level} "{f"&l{level - 1};" * 10}">' for level in range(1, 10))
    cell(solved, 'package_xml')['source'] = (
        '%%rospkg package.xml\n<?xml version="1.0"?>\n<!DOCTYPE package [<!ENTITY l0 "laugh">'
        f'<!ENTITY file SYSTEM "file:///etc/passwd">{laughs}]>\n'
        '<package format="3"><name>temp_monitor_pkg</name><description>&l9;&file;</description>'
        '</package>\n'
    )
    return solved


@attack('outputs of a submission are never read', 0)
def forges_outputs(student, solved, blank):
    """Hand in check cells that already have outputs, which claim full points."""
    for one in checks(blank):
        data = {'text/plain': '15.0', 'text/html': '<script>alert(1)</script>'}
        one['outputs'] = [
            {'output_type': 'execute_result', 'data': data, 'metadata': {}, 'execution_count': 1},
            {'output_type': 'stream', 'name': 'stdout', 'text': 'all checks passed'},
        ]
        one['execution_count'] = 1
    return blank


@attack('an answer has at most 64 KiB', 35, 'at most 64 KiB')
def has_a_giant_answer(student, solved, blank):
    """Hand in an answer that is too large for a compiler or a database."""
    cell(solved, 'temperature_publisher')['source'] += '\n' + 'x = ' + '(' * 5_000_000
    return solved


@attack('long numbers in a submission are not converted', 50)
def has_a_huge_number(student, solved, blank):
    """Make the parser compute for hours on a number with three million digits."""
    return json.dumps(solved)[:-1] + ', "number": ' + '9' * 3_000_000 + '}'


@attack('the text is not interpreted; only the sandbox compiles it', 35)
def has_control_characters(student, solved, blank):
    """Put null bytes, form feeds, lone surrogates and direction marks into an answer."""
    one = cell(solved, 'temperature_publisher')
    one['source'] += '\n\x00\x0c\ud800\u202e\ufeff'
    return solved


@attack('numbers of a submission are not used', 50)
def has_numbers_that_are_none(student, solved, blank):
    """Use NaN and Infinity, which are not JSON, where numbers are compared."""
    solved['metadata']['points'] = [float('nan'), float('inf'), -float('inf')]
    for one in solved['cells']:
        one['execution_count'] = float('nan')
    return solved


@attack('parts of a wrong type count as empty', 0, 'expected cells of this assignment')
def has_parts_of_wrong_types(student, solved, blank):
    """Put numbers, lists and null where strings and objects belong."""
    for number, one in enumerate(blank['cells']):
        one['source'] = (None, 7, [1, None, {}], {'a': 1})[number % 4]
        one['metadata'] = (None, [], 'text', 3)[number % 4]
    blank['cells'] += [None, 3, [], 'text', {'cell_type': ['code']}]
    return blank


@attack('parts are counted before the file is parsed', 0, 'far too many JSON values')
def has_too_many_parts(student, solved, blank):
    """Fill the memory with a small file of countless empty lists."""
    return '{"cells": [' + '[],' * 2_000_000 + '[]]}'


class Payload:
    """Runs a command when it is unpickled."""

    def __reduce__(self):
        return os.system, (f'touch {PAYLOAD}',)


@attack(
    'metadata of a submission are dropped; nothing is unpickled, and YAML is only read '
    'from the course',
    50,
)
def hides_payloads_in_metadata(student, solved, blank):
    """Leave pickles, YAML objects and templates wherever a tool might load them."""
    pickled = base64.b64encode(pickle.dumps(Payload())).decode()
    loaded = f'!!python/object/apply:os.system ["touch {PAYLOAD}"]'
    poison = {'pickle': pickled, 'yaml': loaded, 'jinja': '{{ 7 * 7 }}', '__class__': 'os.system'}
    solved['metadata'].update(jupytext=poison, otter=poison, widgets=poison, toc=poison)
    for one in solved['cells']:
        one['metadata'].update(poison=poison, slideshow=loaded)
        one['attachments'] = {'x.svg': {'image/svg+xml': '<svg onload="alert(1)"/>'}}
    return solved


@attack('no cell of the notebook is executed', 0)
def hooks_the_kernel(student, solved, blank):
    """Register input and AST transformers, display hooks and patches that change the checks."""
    blank['cells'].insert(
        0,
        code(
            'import ast, builtins, sys\n'
            'shell = get_ipython()\n'
            'class Nothing(ast.NodeTransformer):\n'
            '    def visit_Assert(self, node):\n'
            '        return ast.Pass()\n'
            'shell.ast_transformers.append(Nothing())\n'
            'shell.input_transformers_cleanup.append(lambda lines: ["15.0"])\n'
            'sys.displayhook = print\n'
            'import autograder.judging.judge\n'
            'autograder.judging.judge.judge = lambda *anything: ()\n'
            f'open({str(PAYLOAD)!r}, "w")\n'
        ),
    )
    return blank


@attack(
    'Markdown is cleaned with a list of allowed tags and attributes; MathJax runs in its '
    'safe mode',
    50,
)
def injects_markup(student, solved, blank):
    """
    Put scripts, event handlers, pictures, links and formulas with commands into an answer that
    a person reads.
    """
    cell(solved, 'explain_threshold')['source'] = (
        '# <script>alert(1)</script>\n'
        '<img src=x onerror="alert(2)"> [link](javascript:alert(3)) ![p](http://192.0.2.1/p.png)\n'
        '<svg/onload=alert(4)> <iframe srcdoc="<script>alert(5)</script>"></iframe>\n'
        '<style>body{display:none}</style> <form action=x><input name=score value=40></form>\n'
        '<a href="data:text/html,<script>alert(6)</script>">x</a> <base href="http://192.0.2.1/">\n'
        '$\\href{javascript:alert(7)}{x}$ \x1b[2J\x07 </textarea></pre></script> {{ 7 * 7 }}\n'
    )
    return solved


@attack(REBUILT, 0, 'the release has no cell with the grade id')
def invents_graded_cells(student, solved, blank):
    """Add further cells that nbgrader would count."""
    for number in range(3):
        bonus = code('1000.0')
        bonus['metadata']['nbgrader'] = {
            'grade_id': f'bonus_{number}',
            'grade': True,
            'solution': False,
            'locked': True,
            'points': 1000,
            'schema_version': 3,
        }
        blank['cells'].append(bonus)
    return blank


@attack(IN_WORDS, 0, 'format 3')
def is_an_old_format(student, solved, blank):
    """Hand in a notebook in format 3, which stores its cells in worksheets."""
    return {'worksheets': [{'cells': solved['cells']}], 'metadata': {}, 'nbformat': 3}


@attack('an error instead of a score for the rest', 0, 'ends in the middle')
def is_cut_off(student, solved, blank):
    """Hand in half of a file."""
    text = json.dumps(solved)
    return text[: len(text) // 2]


@attack('files above 16 MiB are not read', 0, 'a file of at most 16 MiB')
def is_huge(student, solved, blank):
    """Hand in a file that is too large to read."""
    solved['metadata']['padding'] = 'x' * (17 << 20)
    return solved


@attack('a depth limit, and a readable error', 0, 'nested too deeply')
def is_nested_deeply(student, solved, blank):
    """Break the parser with deeply nested lists."""
    return '{"cells": ' + '[' * 200_000 + ']' * 200_000 + '}'


@attack(IN_WORDS, 0, 'not JSON')
def is_no_json(student, solved, blank):
    """Hand in a web page."""
    return '<!DOCTYPE html><html><script>alert(1)</script></html>'


@attack(IN_WORDS, 0, 'not UTF-8')
def is_not_utf8(student, solved, blank):
    """Hand in a notebook that is not UTF-8."""
    return json.dumps(solved, ensure_ascii=False).encode('utf-16')


@attack(
    'names are letters and digits; each answer must be the file that the release names',
    10,
    'expected the first line',
)
def leads_out_of_the_folder(student, solved, blank):
    """Name files outside the package in the magic lines."""
    for name, line in (
        ('temperature_publisher', '%%node ../../../exams/hidden/temperature_publisher'),
        ('temperature_subscriber', '%%node /tmp/an-attack-of-the-corpus-ran'),
        ('temperature_msg', '%%rosmsg ../../etc/cron.d/x'),
        ('package_xml', '%%rospkg ../package.xml'),
        ('cmakelists', '%%rospkg CMakeLists.txt\x00.py'),
    ):
        cell(solved, name)['source'] = f'{line}\nprint(1)\n'
    return solved


@attack('answers are compiled in the sandbox only', 35)
def nests_an_expression(student, solved, blank):
    """Break the compiler with an expression that is nested too deeply."""
    one = cell(solved, 'temperature_publisher')
    one['source'] += '\nx = ' + '-' * 30_000 + '1\ny = ' + '(' * 9_000 + ')' * 9_000
    return solved


@attack(REBUILT, 0, 'a different value of points')
def raises_the_points(student, solved, blank):
    """Make every check worth a thousand points."""
    for one in checks(blank):
        one['metadata']['nbgrader']['points'] = 1000
    return blank


@attack('the last one counts, and a flag reports the repetition', 0, 'more than once')
def repeats_keys(student, solved, blank):
    """Include two lists of cells, one for people and one for the grader."""
    shown = json.dumps(solved['cells'])
    return f'{{"cells": {shown}, "metadata": {{}}, "nbformat": 4, "nbformat_minor": 5, ' + (
        f'"cells": {json.dumps(blank["cells"])}}}'
    )


@attack(REBUILT, 0, 'has different text', 'a different value of locked')
def rewrites_the_checks(student, solved, blank):
    """Unlock the check cells and replace their code with a score."""
    for one in checks(blank):
        one['metadata'].update(editable=True, deletable=True)
        one['metadata']['nbgrader'].update(locked=False, solution=True)
        one['source'] = '15.0'
    return blank


SEARCH = """%%node temp_publisher
import os

for folder, _, names in os.walk('/'):
    if folder.startswith(('/proc', '/sys', '/usr', '/submission')) or 'site-packages' in folder:
        continue
    for name in names:
        path = os.path.join(folder, name)
        if any(word in path for word in ('submitted', 'gradebook', '/exams/', 'course_secret')):
            print('FOUND', path)
        try:
            with open(path, errors='replace') as file:
                if 'CANARY-' + '7f3a9c' in file.read(1 << 20):
                    print('FOUND', path)
        except OSError:
            continue
"""


@attack('none of these files is mounted where the answer runs', 35)
def searches_for_the_others(student, solved, blank):
    """
    Search for other students' submissions, the gradebook and the hidden exams from inside an
    answer, and print them.
    """
    cell(solved, 'temperature_publisher')['source'] = SEARCH
    return solved


@attack(REBUILT, 0, 'has the tags')
def skips_the_checks(student, solved, blank):
    """
    Give the check cells tags that make nbgrader and Jupyter skip them, for which stock nbgrader
    gives full points.
    """
    for one in checks(blank):
        one['metadata']['tags'] = ['skip-execution', 'raises-exception', 'remove_cell']
    return blank


@attack(NAMED_FILE, 20, 'expected the first line')
def swaps_grade_ids(student, solved, blank):
    """Hand in one answer under the grade id of another."""
    one, other = cell(solved, 'temperature_publisher'), cell(solved, 'temperature_subscriber')
    one['metadata'], other['metadata'] = other['metadata'], one['metadata']
    return solved


@attack('an answer is a file, in which nothing expands magics', 35)
def uses_magics(student, solved, blank):
    """Put shell commands and magics below the answer."""
    one = cell(solved, 'temperature_publisher')
    lines = ['!touch {PAYLOAD}', '%run -m os', '%%bash', f'touch {PAYLOAD}', '%system id']
    one['source'] = one['source'] + '\n' + '\n'.join(lines).replace('{PAYLOAD}', str(PAYLOAD))
    return solved
