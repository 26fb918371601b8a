"""Reading submissions: any bytes give a gradable notebook or a reason for review."""

import json

from fake_grading import answer, cell
import pytest

from autograder.results import Problem, SubmissionResult
from autograder.submission import submission
from autograder.submission.notebook import read_notebook, StudentCell
from autograder.submission.submission import open_submission, rebuild


@pytest.fixture
def release():
    return {
        'cells': [
            cell(source='# Title', kind='markdown'),
            answer('# YOUR CODE HERE'),
            cell('check_talker', "check('talker')", grade=True, locked=True, points=3),
            cell('why', 'YOUR ANSWER HERE', 'markdown', solution=True, grade=True, points=2),
        ],
        'metadata': {'kernelspec': {'name': 'ros2_jazzy'}},
        'nbformat': 4,
        'nbformat_minor': 5,
    }


def bytes_of(*cells):
    return json.dumps({'cells': cells}).encode()


def student_file(release, text):
    """Return a copy of the release whose talker has this text."""
    copy = json.loads(json.dumps(release))
    copy['cells'][1]['source'] = text
    return copy


def source_of(notebook, grade_id):
    return next(
        one['source']
        for one in notebook['cells']
        if one['metadata'].get('nbgrader', {}).get('grade_id') == grade_id
    )


class TestUnusable:
    """If no cell of the assignment can be read, there is no evidence, so a person decides."""

    @pytest.mark.parametrize(
        ('data', 'got'),
        [
            (None, None),
            (b'', 'an empty file'),
            (b'{"cells": [{"cell_type": "co', 'ends in the middle'),
            (b'{"cells": []}', 'a notebook without cells'),
            (bytes_of(cell('other', 'x = 1'), cell()), '2 other cells'),
        ],
    )
    def test_work_without_a_readable_cell_is_unusable(self, data, got, release):
        before = (Problem('submitted/ann', 'a folder', 'no notebook', 'submit again'),)
        opened = open_submission(data, release, 'n.ipynb', before if data is None else ())
        result = SubmissionResult('ann', 'a', problems=opened.problems)

        assert opened.problems[0].unusable
        assert (got or 'no notebook') in result.review
        assert opened.missing == {'talker', 'why'}
        assert opened.flags == ()

    def test_one_cell_of_the_assignment_is_enough(self, release):
        data = bytes_of(cell('check_talker', "check('talker')"))

        opened = open_submission(data, release, 'n.ipynb')

        assert not any(problem.unusable for problem in opened.problems)
        assert opened.missing == {'talker', 'why'}


class TestReadNotebook:
    @pytest.mark.parametrize(
        ('data', 'got'),
        [
            (b'', 'an empty file'),
            (b'  \n', 'an empty file'),
            (b'<html></html>', 'not JSON'),
            (b'PK\x03\x04zip', 'not JSON'),
            (b'{"cells": [{"cell_type": "co', 'ends in the middle, after 28 bytes'),
            (b'{"cells": [{"cell_type": "code"}', 'ends in the middle, after 32 bytes'),
            (b'{"cells": [}\n}', 'broken JSON in line 1'),
            (b'\xff\xfe{\x00}\x00', 'not UTF-8'),
            (b'[]', 'no list of cells'),
            (b'{}', 'no list of cells'),
            (b'{"cells": 3}', 'no list of cells'),
            (b'{"worksheets": []}', 'a notebook in format 3'),
        ],
    )
    def test_bytes_that_are_no_notebook_get_one_clear_line(self, data, got):
        cells, problems = read_notebook(data, 'submitted/ann/x.ipynb')

        assert cells is None
        assert len(problems) == 1
        assert got in problems[0].got
        assert problems[0].line().startswith('submitted/ann/x.ipynb: expected ')
        assert '\n' not in problems[0].line()

    @pytest.mark.parametrize('part', ['"{}",', '"{}":0,', '"{}\\\\",'])
    def test_many_tiny_strings_are_refused_before_they_fill_the_memory(self, part):
        """One object with a million names would take two hundred megabytes."""
        parts = ''.join(part.format(number) for number in range(600_000))

        cells, problems = read_notebook(f'{{"cells": [{parts}'.encode(), 'x')

        assert cells is None
        assert 'too many' in problems[0].got

    def test_a_long_output_with_many_quotes_is_fine(self):
        """Quotes inside a string do not count as strings: HTML tables are full of them."""
        output = {'output_type': 'display_data', 'data': {'text/html': '<td class="a">' * 300_000}}

        found, problems = read_notebook(bytes_of({**cell('a', 'x'), 'outputs': [output]}), 'x')

        assert problems == ()
        assert found[0].source == 'x'

    def test_parts_of_the_wrong_type_count_as_empty(self):
        cells = [
            None,
            {'cell_type': 3, 'source': {'a': 1}, 'metadata': []},
            {'cell_type': 'code', 'source': ['a\n', 1, 'b'], 'metadata': {'nbgrader': 'x'}},
            {'cell_type': 'code', 'source': 'x', 'metadata': {'nbgrader': {'grade_id': [1]}}},
        ]

        found, problems = read_notebook(bytes_of(*cells), 'x')

        assert problems == ()
        assert [one.source for one in found] == ['', '', 'a\nb', 'x']
        assert {one.grade_id for one in found} == {''}

    def test_a_byte_order_mark_and_windows_line_ends_are_fine(self):
        data = json.dumps({'cells': [cell('a', 'x\r\ny\rz')]}).encode('utf-8-sig')

        found, problems = read_notebook(data, 'x')

        assert problems == ()
        assert found[0].source == 'x\ny\nz'

    def test_half_a_surrogate_pair_becomes_writable_text(self):
        """JSON can contain a lone surrogate, but a text file cannot."""
        found, _ = read_notebook(b'{"cells": [{"source": "a\\ud800b"}]}', 'x')

        assert found[0].source.encode('utf-8') == b'a?b'


def code(grade_id, source):
    return StudentCell(grade_id, 'code', source)


WHY = StudentCell('why', 'markdown', 'because')
CHECK = code('check_talker', "check('talker')")


class TestRebuild:
    def test_answers_are_found_by_grade_id_wherever_they_stand(self, release):
        talker = code('talker', '%%node talker\nprint()')

        notebook, problems = rebuild(release, [WHY, code('', 'scratch'), talker, CHECK])

        assert problems == ()
        assert source_of(notebook, 'talker') == '%%node talker\nprint()'
        assert source_of(notebook, 'why') == 'because'
        assert len(notebook['cells']) == len(release['cells'])

    def test_tags_metadata_and_outputs_of_the_student_are_dropped(self, release):
        """A tag makes nbgrader skip a cell, and an output makes it give points."""
        content = student_file(release, '%%node talker\npass')
        for one in content['cells']:
            one['metadata']['tags'] = ['skip-execution']
            if one['cell_type'] == 'code':
                one['outputs'] = [{'output_type': 'execute_result', 'data': {'text/plain': '3'}}]
        content['metadata']['kernelspec'] = {'name': 'evil'}

        opened = open_submission(json.dumps(content).encode(), release, 'x')

        assert 'skip-execution' not in json.dumps(opened.notebook)
        assert 'execute_result' not in json.dumps(opened.notebook)
        assert opened.notebook['metadata'] == release['metadata']

    def test_the_release_itself_is_not_changed(self, release):
        """Many threads share the release."""
        before = json.dumps(release)

        rebuild(release, [code('talker', 'x')])

        assert json.dumps(release) == before

    def test_a_missing_cell_leaves_the_stub_and_is_named(self, release):
        notebook, problems = rebuild(release, [WHY], 'x')

        assert [problem.cells for problem in problems] == [('talker',)]
        assert source_of(notebook, 'talker') == '%%node talker\n# YOUR CODE HERE'
        assert source_of(notebook, 'why') == 'because'

    def test_a_renamed_cell_is_recognised_by_its_magic_line(self, release):
        student = [code('talker-Copy1', '%%node talker\npass'), WHY]

        _, problems = rebuild(release, student, 'x')

        assert problems[0].cells == ('talker',)
        assert "talker.py with grade id 'talker-Copy1'" in problems[0].got

    def test_of_duplicated_cells_the_first_counts_and_nothing_is_lost(self, release):
        student = [code('talker', 'first'), code('talker', 'second'), WHY]

        notebook, problems = rebuild(release, student)

        assert source_of(notebook, 'talker') == 'first'
        assert '2; the first one counts' in problems[0].got
        assert problems[0].cells == ()

    def test_a_changed_cell_type_is_repaired(self, release):
        """Pressing m in Jupyter, which changes the cell type, costs no points."""
        student = [StudentCell('talker', 'markdown', '%%node talker\n'), code('why', 'because')]

        notebook, problems = rebuild(release, student)

        types = [one['cell_type'] for one in notebook['cells']]
        assert types == ['markdown', 'code', 'code', 'markdown']
        assert [problem.cells for problem in problems] == [(), ()]

    def test_a_changed_check_is_ignored_and_noted(self, release):
        student = [code('talker', 'x'), code('check_talker', '15.0'), WHY]

        notebook, problems = rebuild(release, student)

        assert source_of(notebook, 'check_talker') == "check('talker')"
        assert 'locked' in problems[0].expected
        assert problems[0].cells == ()

    @pytest.mark.parametrize('text', ['x' * 65_537, 'x\r\n' * 40_000, '\u00e9' * 40_000])
    def test_an_answer_above_64_kib_is_missing(self, release, text):
        """An answer is never truncated: truncated code would be a different answer."""
        data = json.dumps(student_file(release, text)).encode()

        opened = open_submission(data, release, 'x')

        assert opened.missing == {'talker'}
        assert 'at most 64 KiB' in opened.problems[0].line()
        assert source_of(opened.notebook, 'talker') == source_of(release, 'talker')

    @pytest.mark.parametrize('text', ['x' * 65_536, 'x\r\n' * 32_768, '\u00e9' * 32_768])
    def test_an_answer_of_64_kib_counts_whole(self, release, text):
        data = json.dumps(student_file(release, text)).encode()

        opened = open_submission(data, release, 'x')

        assert opened.missing == set()
        assert source_of(opened.notebook, 'talker') == text.replace('\r\n', '\n')

    def test_cells_are_looked_through_once_however_many_answers_are_missing(
        self, release, monkeypatch
    ):
        release['cells'] += [
            cell(f'more_{number}', f'%%node more_{number}\n', solution=True)
            for number in range(20)
        ]
        student = [code(f'c{n}', f'%%node c{n}\nx\n') for n in range(100)]
        seen = []
        parse = submission.parse_cell
        monkeypatch.setattr(
            submission, 'parse_cell', lambda source: (seen.append(source), parse(source))[1]
        )

        _, problems = rebuild(release, student)

        assert len(problems) == 22
        assert len(seen) == 100 + 22
        assert not any('\n' in source for source in seen)
