"""A sample may contain its changes to the reference solution instead of whole files."""

from collect_sources import laid
import pytest

from autograder.authoring.sample_class import changed, own_files
from autograder.errors import GraderError

TEXT = 'rate = 1.0\n\nstart()\nwait()\nstart()'


@pytest.mark.parametrize(
    ('diff', 'result'),
    [
        ('@@\n-rate = 1.0\n+rate = 2.0\n', 'rate = 2.0\n\nstart()\nwait()\nstart()'),
        ('@@\n wait()\n-start()\n', 'rate = 1.0\n\nstart()\nwait()'),
        ('@@\n \n+begin()\n', 'rate = 1.0\n\nbegin()\nstart()\nwait()\nstart()'),
        ('@@\n\n+begin()\n', 'rate = 1.0\n\nbegin()\nstart()\nwait()\nstart()'),
        ('@@\n-rate = 1.0\n+rate = 2.0\n\n@@\n-wait()\n', 'rate = 2.0\n\nstart()\nstart()'),
        ('@@\n-rate = 1.0\n@@\n-wait()\n+stop()\n', '\nstart()\nstop()\nstart()'),
    ],
    ids=['line', 'context', 'inserted', 'stripped blank', 'blank at the end', 'two changes'],
)
def test_changes_are_applied(diff, result):
    assert changed(TEXT, diff) == result


@pytest.mark.parametrize(
    ('diff', 'words'),
    [
        ('@@\n-start()\n+stop()\n', 'occur 2 times'),
        ('@@\n-rate = 1\n+rate = 2\n', 'occur 0 times'),
        ('-rate = 1.0\n+rate = 2.0\n', 'does not begin with a line @@'),
        ('--- a\n+++ b\n@@ -1 +1 @@\n-rate = 1.0\n', 'does not begin with a line @@'),
        ('', 'does not begin with a line @@'),
    ],
    ids=['ambiguous', 'part of a line', 'no mark', 'line numbers', 'empty'],
)
def test_a_diff_that_does_not_fit_is_an_error(diff, words):
    with pytest.raises(GraderError, match=words):
        changed(TEXT, diff)


def test_own_files_have_the_names_of_the_files_that_they_change(tmp_path):
    names = ('expected.json', 'talker.py', 'msg/Station.msg.diff')
    laid(tmp_path, dict.fromkeys(names, b''))

    assert own_files(tmp_path) == {
        'talker.py': tmp_path / 'talker.py',
        'msg/Station.msg': tmp_path / 'msg' / 'Station.msg.diff',
    }


def test_a_file_and_its_diff_exclude_each_other(tmp_path):
    laid(tmp_path, {'talker.py': b'', 'talker.py.diff': b''})

    with pytest.raises(GraderError, match=r'both talker\.py and talker\.py\.diff'):
        own_files(tmp_path)
