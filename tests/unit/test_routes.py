"""The table of routes in environment.md shows which commands were executed, and when."""

import json
import re
import subprocess

import pytest

from deploy import routes

REPORT = """
autograder/_work/submitted was empty, so the 3 example submissions from tests were copied there.
│ fail__two │    11 of 18 │ why │
│ pass__one │    18 of 18 │     │
2 submissions in 5.6 s, of which runs took 4.9 s; longest run time: x, 4.5 s; isolation bwrap-user.
│ broken    │  for review │ why │
1 submissions in 3.9 s, of which runs took 3.1 s; isolation bwrap-user; 1 for review.
"""


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Replace the project's rows and page with two rows and a small page."""
    row = {'route': 'r', 'system': 's', 'type': 't', 'date': '', 'result': 'no time'}
    rows = [{'name': 'see-it', **row}, {'name': '-', **row}]
    monkeypatch.setattr(routes.tempfile, 'tempdir', str(tmp_path))
    monkeypatch.setattr(routes, 'ROWS', tmp_path / 'routes.json')
    monkeypatch.setattr(routes, 'PAGE', tmp_path / 'page.md')
    routes.ROWS.write_text(json.dumps(rows))
    routes.PAGE.write_text(f'before\n{routes.BEGIN}old\n{routes.END}after\n')
    return routes


def test_the_table_of_environment_md_agrees_with_its_data():
    rows = json.loads(routes.ROWS.read_text(encoding='utf-8'))
    assert routes.BEGIN + routes.table(rows) + routes.END in routes.PAGE.read_text(
        encoding='utf-8'
    )


def test_each_route_has_one_row_and_each_date_a_route():
    rows = json.loads(routes.ROWS.read_text(encoding='utf-8'))
    assert sorted(row['name'] for row in rows if row['name'] != '-') == sorted(routes.ROUTES)
    for row in rows:
        assert row['result']
        assert re.fullmatch(r'(20\d\d-\d\d-\d\d)?' if row['name'] != '-' else '', row['date'])


def test_a_route_that_works_sets_date_and_result(files, monkeypatch):
    monkeypatch.setitem(routes.ROUTES, 'see-it', lambda folder: 'it worked')
    assert routes.main(['see-it']) == 0
    page = routes.PAGE.read_text()
    assert re.search(r'\| see-it \| r \| s \| t \| 20[\d-]{8} \| it worked, 0 min 0 s \|', page)
    assert '| - | r | s | t | **untried** | no time |' in page
    assert page.startswith('before\n')
    assert page.endswith('after\n')
    assert 'old' not in page


def test_a_route_that_fails_changes_no_row(files, monkeypatch, capsys):
    def fails(folder):
        routes.run(folder, 'sh', '-c', 'echo no network; exit 3')

    monkeypatch.setitem(routes.ROUTES, 'see-it', fails)
    before = json.loads(routes.ROWS.read_text())
    assert routes.main(['see-it']) == 1
    assert json.loads(routes.ROWS.read_text()) == before
    assert capsys.readouterr().err == 'see-it: sh ended with code 3:\nno network\n'


def test_an_unknown_route_is_refused(files, capsys):
    assert routes.main(['moon']) == 2
    assert 'moon: no such route. Try one of: this-machine, plain-user' in capsys.readouterr().err


def test_sample_class_result_counts_submissions():
    assert routes.sample_class_result(REPORT) == '3 submissions, `bwrap-user`'


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('the 3 example', 'the 4 example', '3 submissions were graded'),
        ('18 of 18', '17.5 of 18', 'expected full points for pass__one'),
        ('isolation bwrap-user.', 'isolation landlock.', 'bwrap-user, landlock'),
        ('bwrap-user', 'landlock', 'expected full isolation, got landlock'),
    ],
)
def test_sample_class_result_refuses_less(old, new, words):
    with pytest.raises(routes.RouteFailed, match=words):
        routes.sample_class_result(REPORT.replace(old, new))


def test_commands_of_the_hubs_page_end_with_its_start():
    page = (routes.PROJECT / 'docs' / 'hub.md').read_text(encoding='utf-8')
    commands = routes.commands_of(page)
    assert 'git clone /course course && cd course' in commands
    assert 'cp deploy/hub/hub.toml /etc/ros2_hub.toml' in commands
    assert commands[-1] == 'make hub HUB=/etc/ros2_hub.toml'


def printed_by(command, folder):
    """Return what a route reads from the output of a shell command."""
    pipe = subprocess.PIPE
    with subprocess.Popen(['sh', '-c', command], stdin=pipe, stdout=pipe, text=True) as system:
        return routes.printed(folder, system, routes.OPENED)


def test_printed_finds_the_address_and_the_users_of_a_hub(tmp_path):
    opened = 'echo starts; echo Open http://127.0.0.1:1/ and log in as ann, bob, eve.; echo more'
    assert printed_by(opened, tmp_path) == ('http://127.0.0.1:1/', 'ann', 'bob')
    assert (tmp_path / 'log').read_text().startswith('starts\n')


@pytest.mark.parametrize('end', ['echo no npm', f'echo no npm; echo {routes.ENDED} 2; exec cat'])
def test_printed_reports_a_hub_that_ends_before_it_opens(end, tmp_path):
    """A hub that fails does not keep the route waiting."""
    with pytest.raises(routes.RouteFailed, match='no npm'):
        printed_by(end, tmp_path)
