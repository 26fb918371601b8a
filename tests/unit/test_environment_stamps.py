"""A prepared environment is up to date until one of its inputs changes."""

from collect_sources import laid
import pytest

from environment import stamps
from environment.places import Places


@pytest.fixture
def places(tmp_path):
    files = {'course.toml': b"package = 'temp_monitor_pkg'\n", 'temp_monitor_pkg/test/x.py': b''}
    laid(tmp_path, {**files, 'temp_monitor_pkg/msg/Num.msg': b'int64 num\n'})
    return Places.of('.venv', tmp_path)


def write_ready(places, environ=None):
    """Record that the current project was prepared."""
    stamps.write_ready(places, environ or {}, '3.12', stamps.whole_digest(places))


def test_is_ready_after_write_is_true(places):
    assert not stamps.is_ready(places, {})

    write_ready(places)

    assert stamps.is_ready(places, {})
    assert stamps.is_ready(places, {'PYTHON': '', 'ROS_SOURCE': ''})


@pytest.mark.parametrize('name', ['msg/Num.msg', 'msg/New.msg', 'package.xml'])
def test_is_ready_changed_source_is_false(places, name):
    write_ready(places)
    (places.package / name).write_text('float64 changed\n')

    assert not stamps.is_ready(places, {})


def test_is_ready_changed_test_is_true(places):
    """The package's tests are not installed, so they need no build."""
    write_ready(places)
    laid(places.package, {'test/test_new.py': b'', '__pycache__/x.pyc': b''})

    assert stamps.is_ready(places, {})


def test_is_ready_edited_while_preparing_is_false(places):
    before = stamps.whole_digest(places)
    (places.package / 'msg' / 'Num.msg').write_text('int32 num\n')
    stamps.write_ready(places, {}, '3.12', before)

    assert not stamps.is_ready(places, {})


def test_is_ready_moved_project_is_false(places, tmp_path):
    """The scripts of a venv contain its path, so a moved project is prepared again."""
    write_ready(places)
    moved = tmp_path.with_name('moved')
    tmp_path.rename(moved)

    assert not stamps.is_ready(Places.of('.venv', moved), {})


@pytest.mark.parametrize('text', ['', '{', '[]', '{"digest": 1}'])
def test_is_ready_damaged_stamp_is_false(places, text):
    write_ready(places)
    places.ready.write_text(text)

    assert not stamps.is_ready(places, {})


SOURCED = {'ROS_DISTRO': 'jazzy', 'AMENT_PREFIX_PATH': '/opt/ros/jazzy'}


@pytest.mark.parametrize(
    ('prepared', 'shell', 'ready'),
    [
        # PYTHON=... is compared only if the shell sets it.
        ({'PYTHON': 'python3.11'}, {'PYTHON': 'python3.11'}, True),
        ({'PYTHON': 'python3.11'}, {}, True),
        ({'PYTHON': 'python3.11'}, {'PYTHON': 'python3.12'}, False),
        # A shell with ROS 2 Jazzy sourced does not accept an environment from PyPI.
        ({}, SOURCED, False),
        ({}, {**SOURCED, 'ROS_DISTRO': 'humble'}, True),
        # An environment with a sourced ROS 2 is ready in shells that do not source it.
        (SOURCED, SOURCED, True),
        (SOURCED, {}, True),
        (SOURCED, {'ROS_SOURCE': 'wheels'}, False),
    ],
)
def test_is_ready_compares_what_the_shell_requests(places, prepared, shell, ready):
    """A shell without a request accepts any prepared environment."""
    write_ready(places, prepared)

    assert stamps.is_ready(places, shell) == ready


def test_digest_of_borders_count():
    assert stamps.digest_of('ab', 'c') != stamps.digest_of('a', 'bc')
