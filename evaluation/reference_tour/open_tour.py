"""Orders places to a short tour that begins at the first and ends anywhere."""

from collections.abc import Mapping, Sequence

Lengths = Mapping[tuple[int, int], float]
"""Length of the way between each two places [m], the same both ways."""

ROUNDING = 1e-6
"""A change that saves less than this [m] is none: the search must end."""

LONGEST_MOVED = 3
"""Places that or-opt moves together at most (Or 1976)."""

_Table = list[list[float]]


def nearest_neighbours(places: Sequence[int], lengths: Lengths) -> list[int]:
    """From each place to the nearest that was not visited yet, the first one first."""
    tour, left = [places[0]], list(places[1:])
    while left:
        here = tour[-1]
        nearest = min(left, key=lambda place: (lengths[here, place], place))
        left.remove(nearest)
        tour.append(nearest)
    return tour


def improved(tour: Sequence[int], lengths: Lengths) -> list[int]:
    """Turn stretches round (2-opt, Croes 1958) and move short ones (or-opt) while that helps.

    Args:
        tour: Places in some order; the first stays the first, any other may become the last.
        lengths: Of the ways between them.
    """
    table = [[*(lengths[a, b] for b in tour), 0.0] for a in tour]
    table.append([0.0] * len(table[0]))
    order = list(range(len(table)))  # the last stands for an end that no way leads to
    while _turn_stretch(order, table) or _move_stretch(order, table):
        pass
    return [tour[k] for k in order[:-1]]


def _turn_stretch(order: list[int], table: _Table) -> bool:
    """Turn round each stretch for which that is shorter, in place; whether there was any."""
    changed = False
    for i in range(1, len(order) - 2):
        for j in range(i + 1, len(order) - 1):
            a, b, c, d = order[i - 1], order[i], order[j], order[j + 1]
            if table[a][c] + table[b][d] < table[a][b] + table[c][d] - ROUNDING:
                order[i : j + 1] = order[i : j + 1][::-1]
                changed = True
    return changed


def _move_stretch(order: list[int], table: _Table) -> bool:
    """Move the first short stretch for which that is shorter, in place; whether there was any."""
    for size in range(1, LONGEST_MOVED + 1):
        for i in range(1, len(order) - size):
            stretch, rest = order[i : i + size], order[:i] + order[i + size :]
            before, after = order[i - 1], order[i + size]
            saved = table[before][stretch[0]] + table[stretch[-1]][after] - table[before][after]
            for j in range(1, len(rest)):
                a, d = rest[j - 1], rest[j]
                straight = table[a][stretch[0]] + table[stretch[-1]][d]
                turned = table[a][stretch[-1]] + table[stretch[0]][d]
                if min(straight, turned) - table[a][d] < saved - ROUNDING:
                    moved = stretch if straight <= turned else stretch[::-1]
                    order[:] = rest[:j] + moved + rest[j:]
                    return True
    return False
