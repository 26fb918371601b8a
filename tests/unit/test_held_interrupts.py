"""Interrupts during steps that must be completed."""

import os
import signal

import pytest

from roslab.interrupts import HeldInterrupts


def _interrupt():
    os.kill(os.getpid(), signal.SIGINT)


def whole_step(done):
    with HeldInterrupts():
        _interrupt()
        done.append('the step')


def outer_step(done):
    """Otherwise the outer step would end between creating a node and registering it."""
    with HeldInterrupts():
        with HeldInterrupts():
            _interrupt()
        done.append('the step')


def constructor(done):
    """A learner's constructor is not called after an interrupt."""
    with HeldInterrupts() as interrupts:
        _interrupt()
        with interrupts.allowed():
            done.append('the constructor')


@pytest.mark.parametrize(
    ('step', 'expected'),
    [(whole_step, ['the step']), (outer_step, ['the step']), (constructor, [])],
)
def test_an_interrupt_comes_when_the_step_is_done_or_where_it_is_allowed(step, expected):
    done = []
    with pytest.raises(KeyboardInterrupt):
        step(done)
    assert done == expected


def test_the_earlier_handler_is_back_afterwards():
    before = signal.getsignal(signal.SIGINT)
    with HeldInterrupts() as interrupts, interrupts.allowed():
        assert signal.getsignal(signal.SIGINT) is before

    assert signal.getsignal(signal.SIGINT) is before
