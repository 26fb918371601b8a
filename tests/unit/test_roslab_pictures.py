"""roslab's layouts, pictures and texts, made from plain data."""

import html
from itertools import combinations, pairwise
import json
import math
import re
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

pytest.importorskip('rclpy')

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import ByteMultiArray, Empty, Float64, Header, Int32MultiArray, String

from autograder.simulated import TopicRecord
from drawing import svg
from drawing.connections import draw_connections, Edge, TopicBox
from drawing.graph_layout import arrange
from drawing.slider import MAX_MOMENTS, slider
from roslab.cli_text import (
    COMPLETE,
    echo_text,
    hz_text,
    message_yaml,
    node_info_text,
    topic_info_text,
    topic_list_text,
)
from roslab.errors import RoslabError
from roslab.fields import number_getter, numeric_fields
from roslab.graph_facts import Endpoint, Facts, mismatch, Topic
from roslab.graph_picture import Graph
from roslab.plot_picture import Curve, curve_html, curve_text
from roslab.timeline_picture import timeline

STRING, INT = 'std_msgs/msg/String', 'std_msgs/msg/Int32'
RELIABLE = QoSProfile(depth=10)
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
LASTING = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def end(node, kind=STRING, qos=RELIABLE):
    return Endpoint(node, kind, qos)


def chatter(publishers, subscriptions, nodes=()):
    """Return the facts of a graph with one topic."""
    names = {*nodes, *(one.node for one in (*publishers, *subscriptions) if not one.hidden)}
    topic = Topic('/chatter', tuple(publishers), tuple(subscriptions))
    return Facts(tuple(sorted(names)), (topic,), False)


def drawing(page):
    """Return the SVG of a page as a tree; parsing fails if the SVG is not well formed."""
    return ElementTree.fromstring(re.search(r'<svg.*</svg>', page, re.DOTALL)[0])


def words(page):
    """Return all text elements of a picture, without its title and description."""
    return [e.text for e in drawing(page).iter('{http://www.w3.org/2000/svg}text')]


def test_connected_pair_is_one_line_of_text_and_has_no_dashes():
    graph = Graph(chatter([end('/talker')], [end('/listener')]))

    assert str(graph).splitlines()[0] == f'/talker --> /chatter [{STRING}] --> /listener'
    assert 'stroke-dasharray' not in graph._repr_html_()


DEADLINE = QoSProfile(depth=1, deadline=Duration(seconds=0.5))
WANTS_RELIABLE = 'reliability: offers BEST_EFFORT, wants RELIABLE'
WANTS_LASTING = 'durability: offers VOLATILE, wants TRANSIENT_LOCAL'


@pytest.mark.parametrize(
    ('publishers', 'subscriptions', 'reason'),
    [
        ([end('/a')], [], 'nobody subscribes'),
        ([], [end('/b')], 'nobody publishes'),
        ([end('/a')], [end('/b', INT)], f'type differs: {STRING} | {INT}'),
        ([end('/a', qos=BEST_EFFORT)], [end('/b')], WANTS_RELIABLE),
        ([end('/a')], [end('/b', qos=DEADLINE)], 'deadline: offers none, wants 0.5 s'),
        (
            [end('/a', qos=BEST_EFFORT)],
            [end('/b', qos=LASTING)],
            f'{WANTS_RELIABLE}; {WANTS_LASTING}',
        ),
    ],
)
def test_endpoint_without_a_match_is_dashed_and_says_why(publishers, subscriptions, reason):
    graph = Graph(chatter(publishers, subscriptions))
    page = graph._repr_html_()

    assert reason in str(graph)
    assert '- ->' in str(graph)
    assert reason in ' '.join(words(page))
    assert page.count('stroke-dasharray') == len(publishers) + len(subscriptions)


def test_fitting_qos_that_is_not_equal_is_no_mismatch():
    """A publisher may offer more than a subscription requests."""
    assert mismatch(end('/a', qos=LASTING), end('/b', qos=BEST_EFFORT)) == ''


def test_only_the_refused_one_of_two_listeners_is_dashed():
    graph = Graph(chatter([end('/a')], [end('/b'), end('/c', qos=LASTING)]))

    assert f'/a --> /chatter [{STRING}] --> /b' in str(graph)
    assert f'/a - -> /chatter [{STRING}] - -> /c   durability' in str(graph)
    assert graph._repr_html_().count('stroke-dasharray') == 1
    assert '/a - -> /c:' in words(graph._repr_html_())


def test_listener_of_the_notebook_is_not_drawn_but_counts():
    facts = chatter([end('/a')], [end('/_roslab')])

    assert 'this notebook listens' in str(Graph(facts))
    assert '_roslab' not in Graph(facts)._repr_html_()
    assert facts.edges[0].matched


def test_listener_of_the_notebook_that_does_not_fit_is_named_with_the_reason():
    (edge, *_) = chatter([end('/a', qos=BEST_EFFORT)], [end('/_roslab')]).edges

    assert not edge.matched
    assert 'reliability' in edge.remark
    assert 'this notebook' in edge.remark


def test_topic_on_which_only_the_notebook_listens_is_drawn_as_lonely():
    """A listener with a misspelt topic is the mistake that the picture has to show."""
    facts = chatter([], [end('/_roslab')], nodes=['/_roslab'])

    assert '/chatter [std_msgs/msg/String] - -> /_roslab' in str(Graph(facts))
    assert 'nobody publishes' in words(Graph(facts)._repr_html_())


def test_names_from_other_programs_are_text_never_markup():
    page = Graph(chatter([end('/<script>')], [end('/b"onload="x')]))._repr_html_()

    assert '<script>' not in page
    drawing(page)


def test_two_nodes_of_one_name_and_an_idle_one_are_reported():
    graph = Graph(Facts(('/idle', '/twin', '/twin'), ()))

    assert str(graph).splitlines()[:2] == ['/idle', '/twin (2 nodes)']
    assert 'Seen now: 3 nodes, 0 topics' in str(graph)
    assert '/twin (2 nodes)' in words(graph._repr_html_())


def test_empty_graph_says_that_nothing_is_seen():
    assert str(Graph(Facts((), ()))) == 'No nodes are visible now.'
    assert words(Graph(Facts((), ()))._repr_html_())[-1] == 'No nodes are visible now.'


def test_picture_has_a_role_and_words_for_those_who_cannot_see_it():
    tree = drawing(Graph(chatter([end('/talker')], []))._repr_html_())
    labels = tree.get('aria-labelledby').split()
    described = {e.get('id'): e.text for e in tree if e.get('id') in labels}

    assert tree.get('role') == 'img'
    assert len(described) == 2
    assert '/talker' in ' '.join(described.values())
    assert 'nobody subscribes' in ' '.join(described.values())


def test_picture_that_scrolls_can_be_reached_by_the_keyboard():
    page = svg.picture(900, 100, 'A <graph>', 'words', [])

    assert page.startswith('<div role="group" aria-label="A &lt;graph&gt;" tabindex="0" style="ov')
    assert '<details' not in page


def table(page):
    found = ElementTree.fromstring(re.search(r'<table.*</table>', page, re.DOTALL)[0])
    return [[cell.text or '' for cell in row] for row in found.iter('tr')]


def test_picture_has_its_data_in_a_table():
    seen = Graph(chatter([end('/talker')], [end('/ear', INT)], ['/idle']))
    head, *rows = table(seen._repr_html_())
    names, *values = table(curve_html(Curve('/t value', ((0.5, 1.0), (1.0, 3.0)), 2.0, 2.0)))

    assert head == ['node', 'does', 'topic', 'type', 'connected', 'remark']
    assert [row[:3] for row in rows] == [
        ['/talker', 'publishes', '/chatter'],
        ['/ear', 'subscribes to', '/chatter'],
        ['/idle', 'uses no topic', ''],
    ]
    assert [row[4] for row in rows] == ['no', 'no', '']
    assert [names, *values] == [
        ['seconds', '/t value', 'above 2'],
        ['0.50', '1', 'no'],
        ['1.00', '3', 'yes'],
    ]


def test_table_of_a_long_curve_is_short_and_keeps_its_peak():
    points = tuple((n / 10, 100.0 if n == 777 else 1.0) for n in range(1000))
    rows = table(curve_html(Curve('/t value', points, 100.0)))

    assert len(rows) <= svg.MAX_ROWS + 2
    assert ['77.70', '100'] in rows


SIZES = dict.fromkeys('abcd', (80, 30)) | {'T1': (120, 40), 'T2': (140, 40), 'T3': (90, 70)}
PATHS = ('a T1 c T2 d T1', 'b T1', 'a T3 d T2')
ARROWS = [arrow for path in PATHS for arrow in pairwise(path.split())]


def test_boxes_do_not_overlap_and_lines_end_on_their_boxes():
    layout = arrange(SIZES, ARROWS, frozenset({'T1', 'T2', 'T3'}))

    for one, other in combinations(layout.spots.values(), 2):
        apart_x = abs(one.x + one.width / 2 - other.x - other.width / 2)
        beside = apart_x >= (one.width + other.width) / 2
        assert beside or abs(one.y - other.y) >= (one.height + other.height) / 2
    assert set(layout.routes) == set(ARROWS)
    for (start, stop), points in layout.routes.items():
        for key, (x, y) in ((start, points[0]), (stop, points[-1])):
            spot = layout.spots[key]
            assert x in (pytest.approx(spot.x), pytest.approx(spot.x + spot.width))
            assert abs(y - spot.y) <= spot.height / 2


def test_layout_is_the_same_each_time_and_topics_stand_in_odd_layers():
    topics = frozenset({'T1', 'T2', 'T3'})
    one, two = (arrange(SIZES, ARROWS, topics) for _ in range(2))

    assert one.spots == two.spots
    assert one.routes == two.routes
    assert all(spot.layer % 2 == (key in topics) for key, spot in one.spots.items())


def test_connections_without_notes_are_drawn():
    edge = Edge('/talker', '/chatter', outward=True, matched=True)
    topics = {'/chatter': TopicBox('/chatter', ['String'])}

    picture = draw_connections({'/talker': 'talker'}, topics, [edge], 'T', 'D', [('node',)])

    assert '/talker publishes /chatter' in picture


def listener(topic, began, times):
    """Return the parts of a listener that timeline() needs."""
    return SimpleNamespace(topic=topic, began=began, times=times, msg_type=String)


def test_timeline_puts_all_sources_on_the_axis_of_the_first():
    line = timeline(listener('/a', 10.0, [0.5, 1.0]), listener('/b', 12.0, [0.5]))

    assert line.rows[0].times == (0.5, 1.0)
    assert line.rows[1].times == (2.5,)
    assert line.rows[0].amount == '2 messages, 2.0 Hz'
    assert re.search(r'^/b +1 +- +2\.50$', str(line), re.MULTILINE)


def test_timeline_compares_a_simulation_with_a_live_plot():
    record = TopicRecord('/a', STRING, (1.0, 2.0), ({}, {}), 2.0)
    run = SimpleNamespace(listeners=[record])
    line = timeline(run, SimpleNamespace(listener=listener('/a', 58_209.0, [0.5, 1.5])))

    assert [row.times for row in line.rows] == [(1.0, 2.0), (0.5, 1.5)]
    assert [row.more for row in line.rows] == [STRING, STRING]


def test_timeline_draws_a_tick_per_message_and_another_shape_per_mark():
    marks = {'stopped': [1.5], 'started': [1.8]}
    page = timeline(listener('/a', 0.0, [0.0, 1.0, 2.0]), marks=marks)._repr_html_()
    paths = drawing(page).iter('{http://www.w3.org/2000/svg}path')
    shapes = {re.sub(r'[-\d. ]+', '', one.get('d')) for one in paths}

    assert len(re.findall(r'M[\d.]+ [\d.]+v18', page)) == 3
    assert len(shapes) == 3
    assert 'stopped: 1 mark' in page


def test_timeline_of_the_last_seconds_leaves_older_messages_out():
    line = timeline(listener('/a', 0.0, [0.0, 4.0, 5.0]), seconds=2.0)

    assert line.rows[0].times == (4.0, 5.0)
    assert (line.begin, line.end) == (3.0, 5.0)


def test_timeline_of_a_recorded_run_has_a_slider_with_the_state_at_each_message():
    one = TopicRecord('/a', STRING, (1.0, 3.0), ({'data': 'x'}, {'data': '<y>'}), 4.0)
    other = TopicRecord('/b', STRING, (2.0,), ({'data': 'z'},), 4.0)
    page = timeline(SimpleNamespace(listeners=[one, other]))._repr_html_()
    held = html.unescape(re.search('data-moments="([^"]*)"', page)[1])
    places, words = zip(*json.loads(held))

    assert words == (
        '1.00 s, a message on /a. Latest: /a: data: x',
        '2.00 s, a message on /b. Latest: /a: data: x; /b: data: z',
        '3.00 s, a message on /a. Latest: /a: data: <y>; /b: data: z',
    )
    assert places[1] - places[0] == pytest.approx(places[2] - places[1], abs=0.2)
    assert f'translate({places[2]})' in page
    assert '<y>' not in page
    assert 'type="range"' not in timeline(listener('/a', 0.0, [1.0]))._repr_html_()


def test_slider_of_many_moments_is_short_and_keeps_the_last():
    page = slider('Run', [(n, f'step {n}') for n in range(1001)], (0.0, 1000.0), 1000.0)
    held = json.loads(html.unescape(re.search('data-moments="([^"]*)"', page)[1]))

    assert len(held) <= MAX_MOMENTS
    assert held[-1] == [1000, 'step 1000']


@pytest.mark.parametrize(
    ('sources', 'marks', 'said'),
    [
        ([], None, 'expected listeners'),
        (['/chatter'], None, "got '/chatter'"),
        ([listener('/a', 0.0, [])], {'x': 'soon'}, "marks['x']"),
    ],
)
def test_timeline_of_something_else_says_what_it_expected(sources, marks, said):
    with pytest.raises(RoslabError, match=re.escape(said)):
        timeline(*sources, marks=marks)


def curve(*values, threshold=None):
    return Curve('/t data', tuple(enumerate(map(float, values))), 20.0, threshold)


def test_values_above_the_threshold_have_another_shape_and_are_counted():
    made = curve(29, 30, 31, threshold=30.0)
    page = curve_html(made)

    assert page.count('<path') - page.count('a2.5 2.5') == 1
    assert '1 above the threshold 30' in curve_text(made)
    assert 'dashed: threshold 30' in words(page)
    assert 'stroke-dasharray' in page


def test_value_that_is_not_finite_is_a_gap():
    page = curve_html(curve(1, 2, math.nan, 3, 4))

    assert page.count('<polyline') == 2
    assert 'nan' not in page.partition('</desc>')[2].partition('</svg>')[0]
    assert '1 not finite' in page


def test_plot_shows_marks_at_their_times_and_those_of_one_time_as_a_pile():
    made = Curve('/t data', ((1.0, 20.0), (2.0, 33.0)), 3.0, 30.0, {'WARN': (2.0, 2.0)})
    page = curve_html(made)

    assert page.count(f'fill="{svg.ORANGE}"') == 2
    assert 'diamond: WARN, dashed: threshold 30' in page
    assert '; WARN at 2.00 s, 2.00 s.' in curve_text(made)
    assert 'WARN at no time' in curve_text(Curve('/t', ((1.0, 2.0),), 3.0, marks={'WARN': ()}))


def test_plot_without_messages_says_that_it_waits():
    assert 'waiting for messages' in words(curve_html(curve(threshold=3.0)))
    assert curve_text(curve()) == '/t data: waiting for messages.'


def test_plot_of_many_values_stays_small_and_keeps_the_extremes():
    points = tuple((number / 1000, 9.0 * (number == 7_777)) for number in range(10_000))
    page = curve_html(Curve('/t data', points, 20.0, 5))

    assert len(page) < 40_000
    assert page.count('<path') == 1
    assert 'from 0 to 9' in page


@pytest.mark.parametrize(('low', 'high'), [(0, 1), (-3.2, 17), (1e-6, 2e-6), (5, 5.001), (0, 9e8)])
def test_axis_has_a_few_round_ticks_inside_its_range(low, high):
    found = svg.ticks(low, high)

    assert 2 <= len(found) <= 12
    assert all(low - 1e-9 <= tick <= high * 1.000001 + 1e-9 for tick in found)


def test_field_paths_reach_nested_fields_and_items_of_arrays():
    header = Header()
    header.stamp.sec = 7

    assert number_getter(Header, 'stamp.sec')(header) == 7.0
    second = number_getter(Int32MultiArray, 'data[1]')
    assert second(Int32MultiArray(data=[3, 4])) == 4.0
    assert second(Int32MultiArray(data=[3])) is None
    assert number_getter(ByteMultiArray, 'data[0]')(ByteMultiArray(data=[b'\x05'])) == 5.0
    assert numeric_fields(Header) == ['stamp.sec', 'stamp.nanosec']


@pytest.mark.parametrize(
    ('kind', 'path', 'said'),
    [
        (Float64, 'dta', "no field 'dta'. Numeric fields: data."),
        (Header, 'frame_id', 'not a number but string. Numeric fields: stamp.sec, stamp.nanosec.'),
        (Header, 'stamp', 'is not a number but builtin_interfaces/Time'),
        (Int32MultiArray, 'data', "Name one of its items, as in 'data[0]'."),
        (Float64, 'data[0]', 'Numeric fields: data.'),
        (String, 'data', 'It has no numeric field; its fields: data.'),
        (Header, 'stamp..sec', 'has no field'),
    ],
)
def test_field_that_does_not_exist_or_is_no_number_is_answered_with_those_that_are(
    kind, path, said
):
    with pytest.raises(RoslabError, match=re.escape(said)):
        number_getter(kind, path)


def test_messages_are_written_as_yaml_in_the_order_of_their_definition():
    header = Header(frame_id='a: b')
    header.stamp.sec = 3

    assert message_yaml(header) == "stamp:\n  sec: 3\n  nanosec: 0\nframe_id: 'a: b'\n"
    assert echo_text(Int32MultiArray(data=[1, 2])).endswith('data:\n- 1\n- 2\n---')
    assert echo_text(Empty()) == '{}\n---'
    assert echo_text(Float64(data=math.nan)) == 'data: .nan\n---'


def test_long_texts_and_arrays_are_cut_unless_all_is_asked_for():
    assert message_yaml(String(data='x' * 200)) == f'data: {"x" * 128}...\n'
    assert message_yaml(String(data='x' * 200), COMPLETE) == f'data: {"x" * 200}\n'
    assert message_yaml(Int32MultiArray(data=range(200))).endswith("- 127\n- '...'\n")


def test_rate_is_computed_from_the_gaps_between_messages():
    assert hz_text([0.0, 1.0, 2.5]) == (
        'average rate: 0.800\n\tmin: 1.000s max: 1.500s std dev: 0.25000s window: 2'
    )


def test_info_and_list_have_the_layout_of_the_tools():
    node = node_info_text('/a', {'Publishers': [('/y', ['p/msg/Y']), ('/x', ['p/msg/X'])]})
    topic = topic_info_text(['p/msg/X', 'p/msg/Y'], ['one'], [])

    assert node.startswith(
        '/a\n  Subscribers:\n\n  Publishers:\n    /x: p/msg/X\n    /y: p/msg/Y\n'
    )
    assert topic == (
        "Type: ['p/msg/X', 'p/msg/Y']\n\nPublisher count: 1\n\none\n\nSubscription count: 0"
    )
    assert topic_list_text([('/b', ['t']), ('/a', ['u'])], types=True) == '/a [u]\n/b [t]'
