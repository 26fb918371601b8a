"""
Present the prepared environment as a sourced ROS 2 installation, as if installed with apt.

A Python without installed packages finds ROS 2 only through the variables of a setup file.
"""

import io
import os
import sys
import sysconfig

from environment import prepare, stamps
from environment.plan import Plan
from environment.ros import join_paths, ros_environment
from environment.steps import run_steps, Screen


def sourced_shell() -> dict[str, str]:
    """Return the environment of a shell in which the stand-in is sourced."""
    base = ros_environment().base_variables
    exported = ('AMENT_PREFIX_PATH', 'LD_LIBRARY_PATH', 'CMAKE_TOOLCHAIN_FILE')
    return {
        **{name: base[name] for name in exported if name in base},
        'HOME': os.environ.get('HOME', '/tmp'),
        'PATH': '/usr/local/bin:/usr/bin:/bin',
        'PYTHON': getattr(sys, '_base_executable', sys.executable),
        'PYTHONPATH': join_paths(sysconfig.get_path('purelib'), base.get('PYTHONPATH', '')),
        'ROS_DISTRO': 'jazzy',
    }


def install_colcon_only(plan: Plan) -> None:
    """Replace pip, which would need the network: make only colcon callable."""
    colcon = plan.places.venv / 'bin' / 'colcon'
    colcon.write_text(
        f'#!{plan.places.python}\n'
        'import sys\nfrom colcon_core.command import main\nsys.exit(main())\n'
    )
    colcon.chmod(0o755)
    stamps.stamp_of(plan.places.notes, 'packages').write_text(plan.digest('packages'))


def go(plan: Plan, *names: str) -> str:
    """Run some of the steps of a plan, and return the displayed text."""
    steps = [step for step in prepare.steps_of(plan) if step.name in names]
    out = io.StringIO()
    assert run_steps(steps, plan.places.notes, Screen(out)), out.getvalue()
    return out.getvalue()
