"""The driver's protocol holds in every order of steps, and each of its rules is needed."""

import pytest

from tests.clock.protocol_model import explore, Model, NEVER, Operation, RULES, ViolationError

SCENARIOS: dict[str, tuple[list[list[Operation]], int]] = {
    # Scripts of the processes, and how many of them exist at the start.
    'a message and its answer': (
        [
            [('sleep', 1), ('send', 1), ('wait', 0, 3), ('compute',)],
            [('wait', 1, NEVER), ('compute',), ('send', 0), ('sleep', 2)],
        ],
        2,
    ),
    'a message as both are due': (
        [[('sleep', 1), ('send', 0), ('sleep', 2)], [('wait', 0, 1), ('wait', 0, 3)]],
        2,
    ),
    'a message that passes through three': (
        [[('send', 1), ('sleep', 2)], [('wait', 1, NEVER), ('send', 2)], [('wait', 2, 1)]],
        3,
    ),
    'two wait for one mailbox': (
        [[('send', 0), ('sleep', 1), ('send', 0)], [('wait', 0, 2)], [('wait', 0, NEVER)]],
        3,
    ),
    'a child': ([[('fork', 1), ('sleep', 2)], [('compute',), ('sleep', 1)]], 1),
    'a child beside another process': (
        [[('fork', 2), ('sleep', 1)], [('sleep', 2)], [('compute',), ('sleep', 3)]],
        2,
    ),
    'two children of a process that ends': (
        [[('fork', 1), ('fork', 2)], [('sleep', 1)], [('compute',)]],
        1,
    ),
    'three in a ring': (
        [
            [('send', 1), ('wait', 0, 2), ('sleep', 3)],
            [('wait', 1, 1), ('send', 2), ('sleep', 2)],
            [('wait', 2, NEVER), ('send', 0), ('compute',)],
        ],
        3,
    ),
    'a wait that never ends': ([[('wait', 0, NEVER)], [('sleep', 1)]], 2),
}


@pytest.mark.parametrize('name', SCENARIOS)
def test_time_moves_only_while_everything_waits_and_every_run_ends(name):
    scripts, begin = SCENARIOS[name]

    assert explore(Model(scripts, begin)) > 100


@pytest.mark.parametrize('rule', RULES)
def test_protocol_without_one_rule_is_refuted(rule):
    def is_refuted(name: str) -> bool:
        scripts, begin = SCENARIOS[name]
        try:
            explore(Model(scripts, begin, [rule]))
        except ViolationError:
            return True
        return False

    assert any(map(is_refuted, SCENARIOS))
