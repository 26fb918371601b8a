"""Interrupts during steps that must be completed."""

import os
import signal

import pytest

from roslab.interrupts import HeldInterrupts


def _interrupt():
    os.kill(os.getpid(), signal.SIGINT)


def test_an_interrupt_comes_when_the_step_is_done():
    done = []

    def step():
        with HeldInterrupts():
            _interrupt()
            done.append('the step')

    with pytest.raises(KeyboardInterrupt):
        step()
    assert done == ['the step']


def test_an_inner_step_passes_its_interrupt_to_the_outer_one():
    """Otherwise the outer step would end between creating a node and registering it."""
    done = []

    def outer():
        with HeldInterrupts():
            with HeldInterrupts():
                _interrupt()
            done.append('the outer step')

    with pytest.raises(KeyboardInterrupt):
        outer()
    assert done == ['the outer step']


def test_an_interrupt_that_came_before_is_delivered_where_it_is_allowed():
    """A learner's constructor is not called after an interrupt."""
    begun = []

    def construct():
        with HeldInterrupts() as interrupts:
            _interrupt()
            with interrupts.allowed():
                begun.append('the constructor')

    with pytest.raises(KeyboardInterrupt):
        construct()
    assert not begun


def test_the_earlier_handler_is_back_afterwards():
    before = signal.getsignal(signal.SIGINT)
    with HeldInterrupts() as interrupts, interrupts.allowed():
        assert signal.getsignal(signal.SIGINT) is before

    assert signal.getsignal(signal.SIGINT) is before
