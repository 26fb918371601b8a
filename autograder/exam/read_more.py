"""
Find the section of lesson 08 that explains an exception.

The lesson of an exam explains its checks; Python's own error messages are explained in lesson 08.
"""

from __future__ import annotations

from collections.abc import Mapping

LESSON = 'lesson 08'
SECTIONS: Mapping[str, tuple[str, ...]] = {
    'Part 1: Imports and packages': (
        'import',
        'indentation',
        'message_not_built',
        'missing_import',
    ),
    'Part 2: Init and shutdown': (
        'destroyed_early',
        'init_name',
        'init_twice',
        'no_init',
        'no_super_init',
        'reserved_name',
    ),
    'Part 3: Spinning and callbacks': ('called_not_passed', 'callback_arguments'),
    'Part 4: Topics and QoS': ('invalid_topic', 'not_a_message', 'not_a_type'),
    'Part 5: Messages and fields': ('field_value', 'no_field'),
    'Part 7: Logging and parameters': (
        'log_arguments',
        'not_declared',
        'one_level_a_place',
        'parameter_type',
    ),
    'How to search here': ('exception', 'no_attribute', 'unknown_name'),
}
"""Headings of the lesson, with the ids of the causes that each section explains."""
_PLACES = {cause: f'{LESSON}, {heading}' for heading, ids in SECTIONS.items() for cause in ids}


def where_to_read(cause_id: str) -> str:
    """
    Return the section that explains an exception, empty if the cause is not an exception.

    :param cause_id: see :class:`autograder.exam.exam.Cause`
    """
    return _PLACES.get(cause_id, '')
