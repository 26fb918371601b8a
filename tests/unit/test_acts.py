"""Find the place of an act that a cause mentions: a line, a function or none."""

import re
import time

import pytest

from autograder.errors import ExamInvalid
from autograder.exam import words
from autograder.judging.causes.text_table import acts_by_cause, FOLDER
from autograder.judging.rows import ANSWER
from autograder.layout import Layout
from autograder.submission.code.acts import OPERATORS, place_of, STATEMENTS
from autograder.submission.code.known_acts import ACTS
from autograder.submission.code.source_code import Code
from exams.visible import managed_pressure, pilot

NODE = """\
import rclpy
from rclpy.node import Node
PERIOD_S = 1.0 / 2
TOPIC = '/hot'
class Watch(Node):
    def __init__(self, depth=3):
        super().__init__('watch')
        self.count, self.limit = 0, 30.0
        self.publisher = self.create_publisher(String, TOPIC, 10)
        self.create_timer(PERIOD_S, self.tick)
        self.create_timer(2.0, self.tock)
        self.create_subscription(Float64, 'heat', self.judge, QoSProfile(depth=1))
        self.heard_at = round(self.limit)
    def judge(self, message):
        if not message.data:
            return
        self.heard_at = self.get_clock().now()
        if int(message.data) > self.limit:
            self.get_logger().warning('hot')
    def tick(self):
        self.count += 1
        text = f'hello {self.count}'
        if self.count != 5:
            self.publisher.publish(String(data=text))
    def tock(self):
        self.get_logger().info('one')
        self.told = True
        self.get_logger().info('two')
"""


def place(acts, about=(), lines=(), code=NODE):
    """Return the line and the function of an act, or None if it has no single place."""
    found = place_of(Code({'watch.py': code}), acts, about, lines)
    return found and (found.line, found.function)


LATER = """\
PROFILE = QoSProfile(depth=1)
class Beacon(LifecycleNode):
    def __init__(self):
        self.ready = False
        self.count = self.first = 0
        self.create_publisher(String, 'map', PROFILE)
        self.create_subscription(String, 'survey', self.take, PROFILE)
    def on_configure(self, state):
        self.first = self.first or self.read()
        self.ready = True
    def on_activate(self, state):
        self.level = self.read()
    def on_cleanup(self, state):
        self.destroy_timer(self.timer)
        self.timer = None
        self.sender = None
    def read(self):
        return self.get_parameter('level').value
    def inspect(self):
        time.sleep(0.12)
    def take(self, message):
        if not (self.first and message.data):
            self.count, self.name = 0, 'none'
        self.count += 1
        if self.count > 9:
            self.last = message
def show(text):
    if text == 'old':
        return
if __name__ == '__main__':
    show('new')
"""


class TestPlace:
    """The place of an act is the smallest part of the code that contains all matches."""

    @pytest.mark.parametrize(
        ('acts', 'line'),
        [
            ('create_subscription()', 12),
            ('create_publisher(1)', 4),  # the line with the name of the topic
            ('data=', 22),  # the line with the value of the field
            ('>', 18),
            ('!=', 23),
            ('if:publish()', 23),
            ('if:warning()', 18),
            ('int()@to:create_subscription()', 18),
            ('round()@def:__init__', 13),
            ('self_made() | publish()', 24),  # the first act that the program performs
        ],
    )
    def test_act_with_one_place_is_found_in_its_line(self, acts, line):
        assert place(acts) == (line, '')

    @pytest.mark.parametrize(
        ('acts', 'line', 'about'),
        [
            ('recount', 23, ()),
            ('compared_count', 25, ()),
            ('kept_first', 9, ()),
            ('stored@def:on_activate', 12, ()),
            ('truth', 22, ()),
            ('==', 28, ()),  # not the line with __name__
            ('profile', 7, ['survey']),  # the publisher shares the profile, which is correct there
            ('get_parameter()@def:on_activate', 12, ()),  # on_configure() shares the helper
            ('get_parameter()', 18, ()),
        ],
    )
    def test_statement_that_sets_something_is_found_by_what_it_does(self, acts, line, about):
        assert place(acts, about, code=LATER) == (line, '')

    @pytest.mark.parametrize(
        ('act', 'about'),
        [
            ('if:show()', ()),
            ('stored@def:on_cleanup', ['']),
            ('recount@def:on_cleanup', ()),
        ],
    )
    def test_what_only_looks_alike_is_no_place(self, act, about):
        found = place(act, about, code=LATER)

        assert found is None or found[1]

    @pytest.mark.parametrize(
        ('acts', 'found'),
        [
            # If the places share only a function, the line of its def is named.
            ('info()', (25, 'tock')),
            ('create_timer()', (6, '__init__')),
            ('def:publish()', (20, 'tick')),
            ('def:tock', (25, 'tock')),
            ('to:create_subscription()', (14, 'judge')),
            ('info()+', (25, 'tock')),
            # Line 13 also rounds, but it is in __init__, which no message reaches.
            ('round() int()', (18, '')),
            *((acts, None) for acts in ('self.x()', 'publish()+', 'info() warning()', 'while')),
            ('abs()', None),
        ],
    )
    def test_act_with_several_places_is_found_in_their_function(self, acts, found):
        assert place(acts) == found

    def test_what_a_callback_calls_belongs_to_it(self):
        """The callback calls hot(), so line 2 belongs to the callback; line 9 does not."""
        code = (
            'def hot(value):\n    return value > 30.0\ndef judge(message):\n'
            '    if hot(message.data):\n        warn()\ndef warn():\n    log.warning(1)\n'
            "node.create_subscription(Float64, 'heat', judge, 10)\nassert 3 > 2\n"
        )

        assert place('>@to:create_subscription()', code=code) == (2, '')
        assert place('if:warning()', code=code) == (4, '')

    def test_log_lines_of_the_run_choose_between_functions(self):
        """The recording contains the line of each log call, which identifies the function."""
        assert place('warning() info()', lines=[19]) == (19, '')
        assert place('log', lines=[26]) == (26, '')
        assert place('warning() info()', lines=[26]) == (25, 'tock')

    def test_lines_of_several_files_would_be_ambiguous(self):
        assert place_of(Code({'a.py': NODE, 'b.py': NODE}), 'publish()') is None
        assert place_of(Code({'a.py': 'def ('}), 'publish()') is None

    def test_unknown_statement_is_a_mistake_of_the_exam(self):
        with pytest.raises(ExamInvalid, match='Use one of: to, if, while'):
            place('wenn:publish()')

    def test_words_of_a_place_are_those_of_the_cell(self):
        """Line numbers in a cell count the magic line as line 1."""
        code = Code({'watch.py': NODE})

        assert place_of(code, 'publish()').words == 'Line 25: '
        assert place_of(code, 'info()').words == 'Line 26, in tock(): '

    def test_each_of_several_places_may_be_a_mistake(self):
        code = Code({'two.py': 'a.create_timer()\n' * 2})

        assert place_of(code, 'create_timer()*').words == 'Lines 2 and 3: '
        assert place_of(Code({'many.py': 'create_timer()\n' * 4}), 'create_timer()*') is None


class TestKnownActs:
    """Acts that a single word of code cannot identify."""

    @pytest.mark.parametrize(
        ('act', 'about', 'line'),
        [
            ('period', ['0.5'], 3),
            ('period', ['2.0'], 11),
            ('slow_period', ['1.8'], 11),
            ('text', ['/hot'], 4),
            ('text', ['/lab/watch'], 7),
            ('endpoint', ['/lab/heat'], 12),
            ('profile', ['hot'], 9),
            ('use', ['RELIABLE', 'std_msgs/msg/Float64'], 12),
            ('function', ['judge'], 14),
            ('says', ['hello 7'], 22),
            ('field', ['data'], 22),
            ('count', [], 21),
            ('depth', [], 12),
            ('truth', [], 15),
            ('early_return', [], 16),
            ('reset', [], 27),
            ('limit', [], 18),
        ],
    )
    def test_act_is_found_by_what_the_run_shows(self, act, about, line):
        assert place(act, about)[0] == line

    def test_innocent_timer_is_not_the_place_of_another_rhythm(self):
        """The program has two timers, and neither has the observed period."""
        assert place('period', ['0.7']) is None

    @pytest.mark.parametrize(
        ('act', 'line'),
        [
            ('own_arguments', 'rclpy.init(args=[])'),
            ('own_arguments', 'rclpy.init(args=args or None)'),
            ('wall_clock', 'stamp = datetime.datetime.now()'),
            ('joined', "value = float(f'{whole}.{rest}')"),
            ('raised_exit', 'raise KeyboardInterrupt'),
            ('stored', 'self.values[one.name] = one.value'),
            ('kept_first', 'self.first = self.first or 3'),
            ('wrapped_count', 'if done: self.count += 1; self.count %= 4'),
            ('conversion', 'celsius = (value - 32) * 0.5556'),
            ('conversion', 'celsius = (value + -32) / 1.8'),
            ('conversion', 'celsius = (value - float(32)) / 1.8'),
            ('slice', 'text = data[:100]'),
        ],
    )
    def test_act_is_found_in_one_statement(self, act, line):
        assert place(act, code=f'rclpy.init(args=args)\n{line}\n') == (2, '')

    @pytest.mark.parametrize(
        ('act', 'line'),
        [
            ('own_arguments', "rclpy.init(args=sys.argv + ['--ros-args'])"),
            ('own_arguments', 'rclpy.init(args=args if args else list(sys.argv))'),
            ('raised_exit', 'try: run()\nexcept SystemExit: pass'),
            ('joined', 'value = float(text)'),
            ('kept_first', 'args = args or sys.argv'),
            ('wrapped_count', 'n += 1\nif not (n % 4 or done): pass'),
            ('wrapped_count', 'n += 1\nif f(n % 4): pass'),
            ('longer_pause+', 'pause = pause + pause + 1\ncreate_timer(pause, tick)'),
        ],
    )
    def test_statement_that_looks_alike_is_not_found(self, act, line):
        assert place(act, code=f'{line}\n') is None

    @pytest.mark.parametrize('act', sorted(ACTS))
    def test_hostile_code_takes_no_time(self, act):
        """Chains of names and sums are followed to a small depth, and searched once."""
        names = '\n'.join(f'a{n} = a{n + 1} + a{n + 1}' for n in range(60))
        deep = f'create_timer({"+".join(["1"] * 500)}, f)\ncreate_timer({10**400}, a0)\n'

        sums = f'self.count = {"+".join(["self.count"] * 400)}\n' * 20
        dots = f'create_timer(a{".b" * 900}, f)\n' * 60
        begun_s = time.process_time()

        place(act, ['0.5'], code=f'{names}\na60 = 1\n{deep}x{".y" * 500} = 1\n')
        place(act, ['0.5'], code=sums + dots)

        assert time.process_time() - begun_s < 3.0


PILOT = """\
node.create_subscription(Float64, 'speed', keep, 10)
node.create_timer(0.5, steer)
node.add_on_set_parameters_callback(changed)
def keep(message):
    node.speed = message.data
    node.came['speed'] = clock.now()
def is_old(moment):
    return clock.now() - moment > OLD
def steer():
    newest = max(node.came.values())
    if is_old(newest):
        command.linear.x = 0.0
    publisher.publish(command)
def changed(parameters):
    self.limit = parameters[0].value
def on_configure(state):
    return node.get_parameter('limit').value
"""


POLITE = """\
class Courier(Node):
    def __init__(self):
        self.pause_s, self.done = 0.1, False
        self.log = get_logger('courier')
        self.timer = self.create_timer(self.pause_s, self.look)
        self.create_timer(1.0, lambda: None)
        self.create_subscription(String, 'calls', self.hear, 10)
    def look(self):
        self.pause_s *= 2
        self.publisher.publish(String())
    def hear(self, message):
        self.done = False
        self.called = message.data
        message.data = message.data.strip()
        self.look()
"""


class TestTable:
    @pytest.mark.parametrize(
        ('acts', 'line'),
        [
            (pilot.WHY['one_age_for_all'].act, 10),
            (acts_by_cause()['half_a_stop'], 12),
            (managed_pressure.WHY['early_limit'].act, 15),
        ],
    )
    def test_innocent_line_with_a_similar_act_is_not_named(self, acts, line):
        """A time is stored, an age compared and a parameter read, all correctly."""
        assert place(acts, code=PILOT) == (line, '')

    @pytest.mark.parametrize(
        ('act', 'line'),
        [
            ('longer_pause', 9),
            ('set_back', 12),
            ('kept_message', 13),
            ('calls_of_callback', 15),
            ('publishing_timer', 5),
        ],
    )
    def test_act_of_a_courier_is_found(self, act, line):
        """Each of these more precise causes of the courier exam has its own act."""
        assert place(act, code=POLITE) == (line, '')

    def test_cause_has_one_row(self):
        """A second row would be ignored."""
        text = (FOLDER / 'places.txt').read_text(encoding='utf-8')
        rows = re.findall(r'^([a-z]\w[\w ]*):', text, re.MULTILINE)
        assert sorted(' '.join(rows).split()) == sorted(acts_by_cause())

    def test_cause_of_the_table_exists(self):
        """The cause of each row exists; a misspelt one would never be looked up."""
        root = Layout.here().root
        text = '\n'.join(
            path.read_text(encoding='utf-8')
            for path in (*root.glob('autograder/[!_]*/**/*'), *root.glob('exams/**/*'))
            if path.suffix in ('.py', '.txt') and path.name != 'places.txt'
        )
        known = set(re.findall(r"^(\w+)|'(\w+)'", text, re.MULTILINE))
        names = {name for pair in known for name in pair}
        qos = ('deadline', 'durability', 'lifespan', 'liveliness', 'reliability')

        assert set(acts_by_cause()) - names - {f'qos_{one}' for one in qos} == set()

    def test_act_of_the_table_is_a_word_that_is_known(self):
        """All acts are known; a misspelt one would be read as a name in the code."""
        shapes = re.compile(
            r'(\w+:)?\w+\(\d?\)|\w+=|def:\w+|[A-Z_]{4,}|qos_profile_\w+|lru_cache|cache|environ|stderr|sensor_id|nan|inf|SystemExit|\w+Group'
        )
        tables = Layout.here().root.glob('exams/**/*.txt')
        rows = [row for table in tables for row in words.rows(table.read_text(encoding='utf-8'))]
        own = [line.removeprefix('act: ') for row in rows for line in row if line[:5] == 'act: ']
        acts = (*acts_by_cause().values(), *own, ANSWER)
        used = {word for one in acts for word in one.split() if word != '|'}
        parts = {part.rstrip('+*') for word in used for part in word.split('@')}

        unknown = {one for one in parts - set(ACTS) - set(OPERATORS) - set(STATEMENTS)}
        unknown = {one for one in unknown if one.partition(':')[2] not in ACTS}
        assert {one for one in unknown if not shapes.fullmatch(one)} == set()
        assert {one.partition(':')[0] for one in unknown if ':' in one} <= {'to', *STATEMENTS}
