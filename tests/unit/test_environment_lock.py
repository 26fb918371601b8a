"""The lock file: exact, complete, and free of addresses."""

from dataclasses import replace
import os
import re
import subprocess
import sys

from packaging.markers import Marker
import pytest

from environment import interpreters, lock
from environment import pins as pins_module
from environment.interpreters import PREFERRED
from environment.places import LOCK_FILE

TEXT = LOCK_FILE.read_text(encoding='utf-8')
PINS = [line for line in TEXT.splitlines() if line and not line.startswith('#')]


def test_lock_has_digests_and_no_addresses_or_paths():
    """Any mirror can serve the packages, and the digests identify the files."""
    for line in PINS:
        assert '--hash=sha256:' in line
        assert not re.search(r'://|@|/', line)


def test_lock_every_line_is_an_exact_pin():
    for line in PINS:
        assert pins_module.PIN.match(line), line
        marker = line.partition(';')[2].partition('--hash')[0]
        assert set(re.sub(pins_module.PYTHON, '', marker).split()) <= {'or'}, line


def test_lock_is_what_render_writes():
    """The lock file was not edited by hand."""
    lines = sorted(PINS, key=lambda line: line.split('==')[0])
    releases = re.search(f'{lock.RESOLVED}(.*)', TEXT)[1].split(', ')

    assert lock.render(lines, releases) == TEXT
    assert [release.rpartition('.')[0] for release in releases] == sorted(PREFERRED)


@pytest.mark.parametrize('python', PREFERRED)
def test_lock_has_every_direct_requirement(python):
    pins = pins_module.pins_for(TEXT, python)
    for line in LOCK_FILE.with_suffix('.in').read_text(encoding='utf-8').splitlines():
        match = re.match(r'([A-Za-z0-9._-]+)(?:\[.*\])?(?:==(\S+))?\s*(;.*)?$', line)
        marker = Marker(match[3].strip('; ')) if match and match[3] else None
        if match and (marker is None or marker.evaluate({'python_version': python})):
            assert match[1] in pins
            assert match[2] in (None, pins[match[1]])


def test_lock_has_one_owner_of_the_lark_folder():
    """Of the two packages that own site-packages/lark, only the newer is installed."""
    pins = pins_module.pins_for(TEXT, '3.12')

    assert 'lark-parser' not in pins
    assert pins['lark'].startswith('1.')


def test_reading_notebooks_compiles_no_grammar():
    """An optional package of jsonschema, which the course omits, made reading ten times slower."""
    loaded = [sys.executable, '-c', 'import nbformat, sys; print("lark" in sys.modules)']
    said = subprocess.run(loaded, capture_output=True, text=True, check=True, timeout=60)

    assert said.stdout.strip() == 'False'
    assert 'rfc3987-syntax' not in pins_module.pins_for(TEXT, '3.12')


def test_pins_for_sourced_leaves_ros_and_numpy_out():
    """A sourced ROS 2 keeps its own packages and the NumPy it was compiled with."""
    pins = pins_module.pins_for(TEXT, '3.12', ros=False)

    assert not [name for name in pins if name.startswith('ros-') or name == 'numpy']
    assert {'jupyterlab', 'nbgrader', 'colcon-ros', 'lark'} <= set(pins)


def test_merge_different_versions_get_markers():
    pins = {
        '3.10': {'a': '1', 'b': '1', 'c': '1', 'e': '1'},
        '3.11': {'a': '1', 'b': '2', 'c': '2'},
        '3.12': {'a': '1', 'b': '2', 'c': '3', 'd': '1'},
        '3.13': {'a': '1', 'b': '2', 'c': '3', 'd': '1', 'e': '1'},
    }

    lines = pins_module.merge(pins)

    assert lines == [
        'a==1',
        'b==1 ; python_version == "3.10"',
        'b==2 ; python_version == "3.11" or python_version == "3.12" or python_version == "3.13"',
        'c==1 ; python_version == "3.10"',
        'c==2 ; python_version == "3.11"',
        'c==3 ; python_version == "3.12" or python_version == "3.13"',
        'd==1 ; python_version == "3.12" or python_version == "3.13"',
        'e==1 ; python_version == "3.10" or python_version == "3.13"',
    ]
    for python, expected in pins.items():
        assert pins_module.pins_for('\n'.join(lines), python) == expected


def test_pins_of_report_uses_one_spelling():
    named = (('Jinja2', '3.1.6'), ('jupyter_client', '8.10.0'))
    left_out = (('lark-parser', '0.12.0'), ('rfc3987-syntax', '1.1.0'))
    installed = [
        {
            'metadata': {'name': name, 'version': version},
            'download_info': {'archive_info': {'hashes': {'sha256': f'of {name}'}}},
        }
        for name, version in (*named, *left_out)
    ]

    pins, digests = lock.pins_of_report({'install': installed})
    assert pins == {'jinja2': '3.1.6', 'jupyter-client': '8.10.0'}
    assert digests == {
        'jinja2==3.1.6': 'of Jinja2',
        'jupyter-client==8.10.0': 'of jupyter_client',
    }


def test_a_line_has_the_files_of_every_python_and_the_set_up_reads_it():
    one, two = 'a' * 64, 'b' * 64
    line = 'x==1 ; python_version == "3.11"'
    (whole,) = lock.with_digests([line], [{'x==1': two}, {'x==1': one}, {'x==1': two}])

    assert whole == f'{line} --hash=sha256:{one} --hash=sha256:{two}'
    assert pins_module.requirements_for(whole, '3.12') == []
    wanted = [f'x==1 --hash=sha256:{one} --hash=sha256:{two}']
    assert pins_module.requirements_for(whole, '3.11') == wanted


def test_oldest_of_each_takes_the_oldest_patch_release():
    """Newer patch releases can install what the oldest one resolves."""
    this = interpreters.probe(sys.executable, os.environ)
    releases = '3.11.7', '3.11.10', '3.11.2', '3.12.1'
    found = [replace(this, release=release) for release in releases]

    assert [item.release for item in lock.oldest_of_each(found)] == ['3.11.2', '3.12.1']
