"""
The grader: runs student code it does not trust and judges what it did on the wire.

The folders, as the data flow::

    submission -> extract -> sandbox + probe (observe) -> recording -> judge -> record, report
"""
