"""roslab rejects a kernel that was started without the ROS environment."""

import pytest

from environment import install_files
from environment.places import Places
from environment.ros import describe_wheels
from roslab import own_kernel


@pytest.fixture
def needed(tmp_path, monkeypatch):
    """Return the variables of a prepared venv, which seems to be the running one."""
    places = Places.of('.venv', tmp_path)
    ros = describe_wheels(places, '/usr')
    install_files.write_description(places, ros)
    monkeypatch.setattr('sys.prefix', str(places.venv))
    return ros.variables


def test_kernel_without_a_variable_is_rejected(needed):
    """VS Code starts such a kernel for the environment that VS Code recommends."""
    lacking = dict(needed)
    del lacking['ROS_PYTHON_CHECK_FIELDS']

    own_kernel.require_variables(needed)
    with pytest.raises(own_kernel.WrongKernelError, match=r'ROS_PYTHON_CHECK_FIELDS.*ROS 2 Jazzy'):
        own_kernel.require_variables(lacking)


def test_python_without_a_description_is_not_checked(tmp_path, monkeypatch):
    monkeypatch.setattr('sys.prefix', str(tmp_path))

    own_kernel.require_variables({})
