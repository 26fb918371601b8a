"""
Place the boxes and lines of a graph, in layers from left to right.

A node that only publishes is left of its topics, a node that only subscribes is right of them, and
a node that does both is between them.  A line that spans several layers gets a position in each
of them, so that no line crosses a box.  Equal graphs give equal pictures.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

Arrow = tuple[str, str]
"""An arrow from one box to another, given by their keys."""

GAP_X = 84.0
_NARROW_GAP_X = 56.0
_MANY_LAYERS = 5
GAP_Y = 18.0
_LINE_HEIGHT = 6.0
_SWEEPS = 8


@dataclass
class Spot:
    """
    The position of a box, or of a line that crosses a layer.

    :param x: left side
    :param y: vertical centre
    """

    key: str
    width: float
    height: float
    layer: int = 0
    x: float = 0.0
    y: float = 0.0


@dataclass
class Layout:
    """
    The positions of all boxes and lines of a graph.

    :param spots: positions of the boxes by key
    :param routes: for each arrow, the points of its line
    """

    spots: dict[str, Spot] = field(default_factory=dict)
    routes: dict[Arrow, list[tuple[float, float]]] = field(default_factory=dict)
    width: float = 0.0
    height: float = 0.0


def arrange(
    sizes: Mapping[str, tuple[float, float]], arrows: Sequence[Arrow], odd: frozenset[str]
) -> Layout:
    """
    Lay out the boxes and lines of a graph.

    :param sizes: width and height of each box, by key, in the order that breaks ties
    :param arrows: without repetition; two boxes may have arrows in both directions
    :param odd: keys of the boxes for odd-numbered layers: the topics
    """
    forward = _without_cycles(list(sizes), arrows)
    layers = _layers(list(sizes), forward, odd)
    spots = {key: Spot(key, *size, layer=layers[key]) for key, size in sizes.items()}
    chains = {arrow: _chain(arrow, spots) for arrow in forward}
    links = sorted({link for chain in chains.values() for link in pairwise(chain)})
    highest = max(layers.values(), default=-1)
    columns = [[s for s in spots.values() if s.layer == layer] for layer in range(highest + 1)]
    _order(columns, links)
    _place_x(columns)
    _place_y(columns, links)
    return _finish(spots, sizes, chains, arrows)


def _without_cycles(keys: list[str], arrows: Sequence[Arrow]) -> list[Arrow]:
    """Return the arrows, with those that close a cycle reversed."""
    targets: dict[str, list[str]] = {key: [] for key in keys}
    for start, end in arrows:
        targets[start].append(end)
    inner = {end for _, end in arrows}
    state: dict[str, str] = {}
    turned: set[Arrow] = set()

    def visit(key: str) -> None:
        state[key] = 'open'
        for end in targets[key]:
            if state.get(end) == 'open':
                turned.add((key, end))
            elif end not in state:
                visit(end)
        state[key] = 'done'

    for key in sorted(keys, key=lambda key: key in inner):  # sources first
        if key not in state:
            visit(key)
    forward = [(end, start) if (start, end) in turned else (start, end) for start, end in arrows]
    return list(dict.fromkeys(forward))


def _layers(keys: list[str], forward: list[Arrow], odd: frozenset[str]) -> dict[str, int]:
    """Return the layer of each box: right of its predecessors; a source is next to a successor."""
    layers = {key: int(key in odd) for key in keys}
    for _ in keys:
        for start, end in forward:
            layers[end] = max(layers[end], layers[start] + 1)
    before = {end for _, end in forward}
    for key in keys:
        after = [layers[end] for start, end in forward if start == key]
        if key not in before and after:
            layers[key] = max(layers[key], min(after) - 1)
    return layers


def _chain(arrow: Arrow, spots: dict[str, Spot]) -> list[str]:
    """Return the keys along a line, with new spots in the layers that the line crosses."""
    start, end = arrow
    keys = [start]
    for layer in range(spots[start].layer + 1, spots[end].layer):
        key = f'\0{start}\0{end}\0{layer}'
        spots[key] = Spot(key, 0.0, _LINE_HEIGHT, layer=layer)
        keys.append(key)
    return [*keys, end]


def _neighbours(links: list[Arrow]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for start, end in links:
        found.setdefault(start, []).append(end)
        found.setdefault(end, []).append(start)
    return found


def _order(columns: list[list[Spot]], links: list[Arrow]) -> None:
    """Sort each layer so that few lines cross: each box goes near the middle of its neighbours."""
    near = _neighbours(links)
    best = _crossings(columns, links), [list(column) for column in columns]
    for sweep in range(_SWEEPS):
        backward = bool(sweep % 2)
        for column in reversed(columns) if backward else columns:
            step = 1 if backward else -1
            where = {
                spot.key: index
                for other in columns
                if other and column and other[0].layer == column[0].layer + step
                for index, spot in enumerate(other)
            }
            here = {spot.key: float(index) for index, spot in enumerate(column)}
            for spot in column:
                beside = [where[key] for key in near.get(spot.key, ()) if key in where]
                if beside:
                    here[spot.key] = sum(beside) / len(beside)
            column.sort(key=lambda spot: here[spot.key])
        crossings = _crossings(columns, links)
        if crossings < best[0]:
            best = crossings, [list(column) for column in columns]
    for column, ordered in zip(columns, best[1]):
        column[:] = ordered


def _crossings(columns: list[list[Spot]], links: list[Arrow]) -> int:
    where = {spot.key: (spot.layer, index) for c in columns for index, spot in enumerate(c)}
    found = 0
    for index, (a, b) in enumerate(links):
        for c, d in links[index + 1 :]:
            if where[a][0] == where[c][0]:
                found += (where[a][1] - where[c][1]) * (where[b][1] - where[d][1]) < 0
    return found


def _place_x(columns: list[list[Spot]]) -> None:
    x = 0.0
    gap = GAP_X if len(columns) < _MANY_LAYERS else _NARROW_GAP_X
    for column in columns:
        width = max((spot.width for spot in column), default=0.0)
        for spot in column:
            # Boxes in a layer have a common centre; a line crosses from side to side.
            spot.x = x + (width - spot.width) / 2 if spot.width else x
            spot.width = spot.width or width
        x += width + gap


def _place_y(columns: list[list[Spot]], links: list[Arrow]) -> None:
    near = _neighbours(links)
    spots = {spot.key: spot for column in columns for spot in column}
    for column in columns:
        _stack(column, {spot.key: 0.0 for spot in column})
    for sweep in range(_SWEEPS):
        for column in reversed(columns) if sweep % 2 else columns:
            wanted = {}
            for spot in column:
                beside = [spots[key].y for key in near.get(spot.key, ())]
                wanted[spot.key] = sum(beside) / len(beside) if beside else spot.y
            _stack(column, wanted)


def _stack(column: list[Spot], wanted: Mapping[str, float]) -> None:
    """Place the boxes of a layer as close to the wanted heights as their order and gaps allow."""
    blocks: list[tuple[float, list[Spot], list[float]]] = []  # mean, spots, offsets
    for spot in column:
        mean, spots, offsets = wanted[spot.key], [spot], [0.0]
        while blocks:
            above_mean, above, above_offsets = blocks[-1]
            shift = above_offsets[-1] + above[-1].height / 2 + GAP_Y + spots[0].height / 2
            if above_mean + shift <= mean:
                break
            blocks.pop()
            total = len(above) + len(spots)
            mean = (above_mean * len(above) + (mean - shift) * len(spots)) / total
            offsets = [*above_offsets, *(offset + shift for offset in offsets)]
            spots = [*above, *spots]
        blocks.append((mean, spots, offsets))
    for mean, spots, offsets in blocks:
        for spot, offset in zip(spots, offsets):
            spot.y = mean + offset


def _finish(
    spots: dict[str, Spot],
    sizes: Mapping[str, tuple[float, float]],
    chains: dict[Arrow, list[str]],
    arrows: Sequence[Arrow],
) -> Layout:
    """Move everything to the origin and connect each line to the sides of its boxes."""
    top = min((spot.y - spot.height / 2 for spot in spots.values()), default=0.0)
    for spot in spots.values():
        spot.y -= top
    layout = Layout({key: spots[key] for key in sizes})
    layout.width = max((spot.x + spot.width for spot in spots.values()), default=0.0)
    layout.height = max((spot.y + spot.height / 2 for spot in spots.values()), default=0.0)
    ends: dict[tuple[str, str], list[tuple[float, Arrow]]] = {}
    lines = {arrow: chains.get(arrow) or chains[arrow[::-1]] for arrow in arrows}
    for arrow, chain in lines.items():
        for side, key, beside in (('e', chain[0], chain[1]), ('w', chain[-1], chain[-2])):
            ends.setdefault((key, side), []).append((spots[beside].y, arrow))
    ports = {
        (key, side, arrow): spots[key].y + _port(index, len(found), spots[key].height)
        for (key, side), found in ends.items()
        for index, (_, arrow) in enumerate(sorted(found))
    }
    for arrow, (first, *between, last) in lines.items():
        points = [(spots[first].x + spots[first].width, ports[first, 'e', arrow])]
        for spot in (spots[key] for key in between):
            points += [(spot.x, spot.y), (spot.x + spot.width, spot.y)]
        points.append((spots[last].x, ports[last, 'w', arrow]))
        layout.routes[arrow] = points if arrow in chains else points[::-1]
    return layout


def _port(index: int, count: int, height: float) -> float:
    """Return the offset from the middle of a box's side at which a line ends."""
    step = min(14.0, (height - 8.0) / max(count - 1, 1))
    return (index - (count - 1) / 2) * step
