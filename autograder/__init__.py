"""
Run student code that the grader does not trust, and judge what it did on the wire.

The folders, as the data flow::

    submission -> extract -> sandbox + probe (observe) -> recording -> judge -> record, report
"""
