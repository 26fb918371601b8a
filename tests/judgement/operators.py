"""
Make single changes to a Python node that imitate the slips of learners.

An operator inspects one node of the syntax tree and yields changes of its text; the rest of the
file stays exactly the same.  How a program ends is taught and not graded, so
``except`` and ``finally`` are left alone.
"""

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
import re

CREATE = {
    'create_publisher': 'publisher',
    'create_lifecycle_publisher': 'publisher',
    'create_subscription': 'subscription',
}
LEVELS = {'info': 'debug', 'warning': 'info', 'error': 'warning'}
COMPARISONS: dict[type[ast.cmpop], str] = {ast.Gt: '>=', ast.Eq: '!='}
ARITHMETIC: dict[type[ast.operator], str] = {
    ast.Add: '-',
    ast.Sub: '+',
    ast.Mult: '/',
    ast.Div: '*',
    ast.Mod: '//',
}
POLICIES = {
    'RELIABLE': 'BEST_EFFORT',
    'BEST_EFFORT': 'RELIABLE',
    'TRANSIENT_LOCAL': 'VOLATILE',
}
OTHER_TYPE = {'Float64': 'Float32', 'String': 'Char', 'Empty': 'Bool', 'Twist': 'Accel'}


@dataclass(frozen=True)
class Change:
    """
    One change to a text.

    :param kind: the kind of slip
    :param start: offset of the first character that is replaced
    :param end: offset after the last character that is replaced
    :param text: the replacement
    :param place: the function that contains the change, empty outside functions
    """

    kind: str
    start: int
    end: int
    text: str
    place: str = ''


@dataclass(frozen=True)
class Place:
    """
    A node of the syntax tree with its parents.

    :param parents: from the outermost to the direct parent
    """

    node: ast.AST
    parents: tuple[ast.AST, ...]
    source: str
    offsets: tuple[int, ...]

    def span(self, node: ast.AST | None = None) -> tuple[int, int]:
        """Return the offsets of a node's text, by default of this node's."""
        it = node or self.node
        return (
            self.offsets[it.lineno - 1] + it.col_offset,
            self.offsets[it.end_lineno - 1] + it.end_col_offset,
        )

    def text(self, node: ast.AST | None = None) -> str:
        """Return the text of a node, by default of this one."""
        start, end = self.span(node)
        return self.source[start:end]

    @property
    def parent(self) -> ast.AST:
        """Return the direct parent."""
        return self.parents[-1]

    @property
    def function(self) -> str:
        """Return the name of the enclosing function, or an empty string."""
        names = [node.name for node in self.parents if isinstance(node, ast.FunctionDef)]
        return names[-1] if names else ''

    def change(self, kind: str, text: str, node: ast.AST | None = None) -> Change:
        """Return the change that replaces a node's text."""
        return Change(kind, *self.span(node), text, self.function)


Operator = Callable[[Place], Iterator[Change]]


def changes(source: str) -> Iterator[Change]:
    """
    Yield every change that an operator finds, in the order of the text.

    :param source: a Python file in ASCII, so that columns are characters
    """
    offsets = [0]
    for line in source.splitlines(keepends=True):
        offsets.append(offsets[-1] + len(line))
    for node, parents in _walk(ast.parse(source), ()):
        place = Place(node, parents, source, tuple(offsets))
        for operator in OPERATORS:
            yield from operator(place)


def _walk(node: ast.AST, parents: tuple[ast.AST, ...]) -> Iterator[tuple[ast.AST, tuple]]:
    """Yield nodes with their parents, without docstrings and code that ends a program."""
    if isinstance(node, ast.ExceptHandler):
        stops = {name for name in ast.walk(node) if isinstance(name, ast.Name)}
        if 'KeyboardInterrupt' in {name.id for name in stops}:
            return
    if hasattr(node, 'lineno'):
        yield node, parents
    for field, value in ast.iter_fields(node):
        if field in ('finalbody', 'returns', 'annotation'):
            continue
        for number, child in enumerate(value if isinstance(value, list) else [value]):
            docstring = field == 'body' and number == 0 and isinstance(child, ast.Expr)
            if isinstance(child, ast.AST) and not (docstring and _is_text(child.value)):
                yield from _walk(child, (*parents, node))


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def called(node: ast.AST) -> str:
    """Return the last name of the called function, or an empty string."""
    if not isinstance(node, ast.Call):
        return ''
    return getattr(node.func, 'attr', getattr(node.func, 'id', ''))


def names(place: Place) -> Iterator[Change]:
    """Change names of nodes, topics, parameters and namespaces, and compared or sent strings."""
    node, parent = place.node, place.parent
    if not _is_text(node) or isinstance(parent, (ast.JoinedStr, ast.FormattedValue)):
        return
    name = str(node.value)
    if name == '__main__':
        return
    by = called(parent)
    if by in CREATE:
        yield place.change('topic', repr(slip(name)))
        yield place.change('absolute name', repr(f'/{name}'))
        yield place.change('private name', repr(f'~/{name}'))
    elif by == '__init__' or (isinstance(parent, ast.Call) and by[:1].isupper()):
        yield place.change('name', repr(slip(name)))
        if by == '__init__':
            yield place.change('namespace', f"{name!r}, namespace='mine'")
    elif isinstance(parent, ast.keyword) and parent.arg == 'namespace':
        yield place.change('namespace', repr(slip(name)))
    elif by not in LEVELS:
        yield place.change('text', repr(name.swapcase()[:1] + name[1:]))


def slip(name: str) -> str:
    """Return a name with two letters in the wrong order."""
    for number in range(1, len(name) - 1):
        if name[number] != name[number + 1]:
            return name[:number] + name[number + 1] + name[number] + name[number + 2 :]
    return f'{name}s'


def numbers(place: Place) -> Iterator[Change]:
    """Change periods, thresholds and counts."""
    value = getattr(place.node, 'value', None)
    if not isinstance(place.node, ast.Constant) or type(value) not in (int, float):
        return
    if called(place.parent) in CREATE:
        return  # a depth, see qos(): it is not visible on the network
    if type(value) is int:
        yield place.change('off by one', str(value + 1))
    elif _is_period(place):
        yield place.change('rate', f'{2 * value}')
        yield place.change('rate', f'{value / 2}')
        yield place.change('unit', f'{1000 * value}')
    else:
        yield place.change('threshold' if value else 'start', f'{value + 0.5}')


def _is_period(place: Place) -> bool:
    """Return whether a number is a period, judged by its name or by the call that takes it."""
    parent = place.parent
    if isinstance(parent, ast.Assign) and isinstance(parent.targets[0], ast.Name):
        return parent.targets[0].id.endswith('_S')
    return called(parent) == 'create_timer' or called(parent)[:1].isupper()


def comparisons(place: Place) -> Iterator[Change]:
    """Change comparisons and the operators that join them."""
    node = place.node
    if isinstance(node, ast.Compare) and not place.text().startswith('__name__'):
        left, right = place.text(node.left), place.text(node.comparators[0])
        other = COMPARISONS.get(type(node.ops[0]))
        if other:
            yield place.change('comparison', f'{left} {other} {right}')
        if isinstance(node.ops[0], ast.Gt):
            yield place.change('comparison', f'{left} < {right}')
    elif isinstance(node, ast.BoolOp):
        left, right = (place.text(value) for value in node.values[:2])
        other = 'or' if isinstance(node.op, ast.And) else 'and'
        yield place.change('comparison', f'{left} {other} {right}')
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield place.change('comparison', place.text(node.operand))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield place.change('sign', place.text(node.operand))


def arithmetic(place: Place) -> Iterator[Change]:
    """Change formulas."""
    node = place.node
    if isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC:
        left, right = place.text(node.left), place.text(node.right)
        if isinstance(node.left, ast.BinOp) and place.source[place.span()[0]] == '(':
            left = f'({left})'
        yield place.change('formula', f'{left} {ARITHMETIC[type(node.op)]} {right}')


def qos(place: Place) -> Iterator[Change]:
    """Change QoS policies, given as a depth or written out."""
    node, parent = place.node, place.parent
    if isinstance(node, ast.Attribute) and node.attr in POLICIES:
        yield place.change('QoS policy', f'{place.text(node.value)}.{POLICIES[node.attr]}')
    elif isinstance(node, ast.keyword) and called(parent) == 'QoSProfile' and node.arg != 'depth':
        yield place.change('QoS policy', '')
    elif isinstance(node, ast.Constant) and called(parent) in CREATE and type(node.value) is int:
        # A subscription that requests less receives the same messages, so this is not a slip.
        if CREATE[called(parent)] == 'publisher':
            yield place.change('QoS policy', 'rclpy.qos.qos_profile_sensor_data')
        durability = 'durability=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL'
        yield place.change('QoS policy', f'rclpy.qos.QoSProfile(depth=10, {durability})')


def logging(place: Place) -> Iterator[Change]:
    """Change levels, loggers and texts of log lines, or print instead of logging."""
    node, parent = place.node, place.parent
    if called(node) in LEVELS and isinstance(node, ast.Call):
        function = place.text(node.func).rpartition('.')[0]
        given = ', '.join(place.text(one) for one in node.args)
        level = LEVELS[called(node)]
        yield place.change('log level', f'{function}.{level}({given})')
        yield place.change('print', f'print({given})')
    elif place.text().endswith('get_logger()') and called(node) == 'get_logger':
        yield place.change('logger', "rclpy.logging.get_logger('mine')")
    elif isinstance(node, ast.FormattedValue) and isinstance(parent, ast.JoinedStr):
        # The offsets of parts of an f-string are correct only in later versions of Python.
        written = ast.unparse(ast.Expression(ast.JoinedStr([node])))[2:-1]
        whole = place.text(parent)
        if whole.count(written) == 1:
            yield place.change('text', whole.replace(written, '...'), parent)


def spinning(place: Place) -> Iterator[Change]:
    """Spin only once, spin a different node, or destroy the node early."""
    node = place.node
    if called(node) != 'spin' or not isinstance(node, ast.Call):
        return
    before, _, given = place.text().partition('spin(')
    yield place.change('spins once', f'{before}spin_once({given}')
    if node.args:
        name = place.text(node.args[0])
        yield place.change('wrong node', "rclpy.spin(rclpy.create_node('helper'))")
        yield place.change('destroyed early', f'{name}.destroy_node(); rclpy.spin({name})')


def removals(place: Place) -> Iterator[Change]:
    """Remove a line."""
    node = place.node
    removable = (ast.Expr, ast.Assign, ast.AugAssign, ast.Return)
    if isinstance(node, ast.If) and '__main__' in place.text(node.test):
        yield place.change('main not called', 'pass', node.body[0])
    given = place.function == 'main' and not re.search(r'spin|add_node', place.text())
    if isinstance(node, removable) and place.function and not given:
        yield place.change(_missing(place.text()), 'pass')


def _missing(text: str) -> str:
    """Return the kind of slip that leaves a line out."""
    for word, kind in (
        ('create_timer', 'missing timer'),
        ('create_publisher', 'missing publisher'),
        ('create_lifecycle_publisher', 'missing publisher'),
        ('create_subscription', 'missing subscription'),
        ('.spin(', 'missing spin'),
        ('to_msg()', 'missing stamp'),
        ('.publish(', 'missing publish'),
        ('super().__init__', 'missing name'),
        ('return', 'missing return'),
        ('get_logger()', 'missing log'),
        ('log.', 'missing log'),
    ):
        if word in text:
            return kind
    return 'missing line'


def types(place: Place) -> Iterator[Change]:
    """Give a field a value of a different type, or import a different message class."""
    node = place.node
    if isinstance(node, ast.Assign) and _is_field(node.targets[0]):
        value = place.text(node.value)
        if isinstance(node.value, (ast.BinOp, ast.Name)):
            yield place.change('whole number', f'int({value})', node.value)
            yield place.change('text for number', f'str({value})', node.value)
        elif value.endswith('.to_msg()'):
            yield place.change('stamp', value.removesuffix('.to_msg()'), node.value)
    elif isinstance(node, ast.keyword) and node.arg == 'data':
        if isinstance(node.value, ast.BinOp):
            yield place.change('whole number', f'data=int({place.text(node.value)})')
            yield place.change('text for number', f'data=str({place.text(node.value)})')
    elif isinstance(node, ast.ImportFrom) and str(node.module).endswith('_msgs.msg'):
        name = node.names[0].name
        yield place.change('type', f'from {node.module} import {OTHER_TYPE[name]} as {name}')
        yield place.change('missing import', 'pass')


def _is_field(node: ast.AST) -> bool:
    """Return whether a target is a field of a message, not an attribute of the node."""
    return isinstance(node, ast.Attribute) and getattr(node.value, 'id', 'self') != 'self'


def endpoint_types(place: Place) -> Iterator[Change]:
    """Change the message class of an endpoint, but not the sent messages."""
    node = place.node
    if not isinstance(node, ast.Name) or called(place.parent) not in CREATE:
        return
    if f'std_msgs.msg import {node.id}' not in place.source:
        yield place.change('type', "__import__('std_msgs.msg').msg.Empty")


def clocks(place: Place) -> Iterator[Change]:
    """Change the clock that gives the time."""
    if place.text() == 'self.get_clock()' and called(place.node):
        yield place.change('stamp', 'rclpy.clock.Clock()')


def callbacks(place: Place) -> Iterator[Change]:
    """Call a callback instead of passing it, or let it block, sleep or raise an exception."""
    node = place.node
    passed = called(place.parent).startswith('create_') and node in place.parent.args
    if passed and place.text().startswith('self.') and isinstance(node, ast.Attribute):
        yield place.change('called, not passed', f'{place.text()}()')
    if not isinstance(node, ast.FunctionDef) or not _is_callback(place, node):
        return
    start, end = place.span(node.body[0])[1], place.span(node.body[-1])[1]
    indent = '\n' + ' ' * node.body[0].col_offset
    loop = f'{indent}import time{indent}while rclpy.ok():{indent}    time.sleep(1.0)'
    yield Change('loop in callback', start, start, loop, node.name)
    yield Change('exception', start, start, f'{indent}self.nubmer += 1', node.name)
    yield Change('ends by itself', end, end, f'{indent}raise SystemExit', node.name)
    if re.search(rf'create_timer\([^()]*\bself\.{node.name}\b', place.source):
        pause = f'{indent}import time{indent}time.sleep(2.0)'
        yield Change('sleep in callback', start, start, pause, node.name)


def _is_callback(place: Place, node: ast.FunctionDef) -> bool:
    """Return whether a method is passed to rclpy."""
    inside = place.source[: place.span()[0]] + place.source[place.span()[1] :]
    return f'self.{node.name})' in inside or f'self.{node.name},' in inside


OPERATORS: tuple[Operator, ...] = (
    names,
    numbers,
    comparisons,
    arithmetic,
    qos,
    logging,
    spinning,
    removals,
    types,
    endpoint_types,
    clocks,
    callbacks,
)
