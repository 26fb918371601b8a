"""Provide the environment variables of processes that a notebook starts."""

from __future__ import annotations

from collections.abc import Mapping
import os

from environment.ros import EnvironmentError_, ros_environment
from roslab.errors import NotHereError


def build_variables() -> dict[str, str]:
    """
    Return the environment variables for building the learner's package.

    This build must not find the course's own package of the same name, so the variables that only
    the course's workspace needs are removed.

    :raises NotHereError: if the environment has not been set up
    """
    try:
        ros = ros_environment()
    except EnvironmentError_ as error:
        raise NotHereError(str(error)) from None
    return _overlaid(os.environ, without=ros.variables, then=ros.base_variables)


def _overlaid(
    current: Mapping[str, str], without: Mapping[str, str], then: Mapping[str, str]
) -> dict[str, str]:
    kept = {name: value for name, value in current.items() if name not in without}
    return {**kept, **then}
