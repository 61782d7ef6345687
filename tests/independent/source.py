# SPDX-License-Identifier: GPL-3.0-or-later
"""What the source of a mesh is, and which grid point each of its positions goes to (docs/reference/format.md, section 17).

Positions are tuples of three floats. Area is decided exactly, with fractions where floats leave it open."""

import math
from fractions import Fraction

LARGEST = (1 << 23) - 1


def cross_terms(a, b, c):
    """For each axis the two products whose difference is the cross product's component."""
    u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
    return [(u[1] * v[2], u[2] * v[1]), (u[2] * v[0], u[0] * v[2]), (u[0] * v[1], u[1] * v[0])]


def has_area(triangle):
    if len(set(triangle)) < 3:
        return False
    for p, q in cross_terms(*triangle):
        if abs(p - q) > 1e-14 * (abs(p) + abs(q)) and abs(p - q) > 1e-290:
            return True
    exact = [tuple(map(Fraction, corner)) for corner in triangle]
    return any(p != q for p, q in cross_terms(*exact))


def edge(a, b):
    return (a, b) if a < b else (b, a)


def is_kept(triangles):
    """Per triangle whether level 0 has it: it has area, or lies along edges of the others and closes T-junctions."""
    kept = [has_area(t) for t in triangles]
    covered = {edge(t[k], t[k - 1]) for t, has in zip(triangles, kept) if has for k in range(3)}
    flat = []  # (triangle, its longest edge, the two others)
    for i, t in enumerate(triangles):
        if not kept[i] and len(set(t)) == 3:
            low, middle, high = sorted(t)  # three points of one line: their order is that along the line
            flat.append((i, edge(low, high), (edge(low, middle), edge(middle, high))))
    changed = True
    while changed:
        before = len(covered)
        for _, longest, others in flat:
            if longest in covered:
                covered.update(others)
            elif others[0] in covered and others[1] in covered:
                covered.add(longest)
        changed = len(covered) != before
    for i, longest, _ in flat:
        kept[i] = longest in covered
    return kept


def grid_points(triangles, origin, step):
    """Position to grid point for the corners of level 0's triangles, needles kept apart."""
    relative = {p: tuple(c - o for c, o in zip(p, origin)) for t in triangles for p in t}
    nearest = {r: tuple(math.floor(c / step + 0.5) for c in r) for r in relative.values()}
    pairs = set()
    for t in triangles:
        corner = [relative[p] for p in t]
        for k in range(3):
            a, b, tip = corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]
            n = nearest[a]
            if a != b and n == nearest[b] and max(abs(x - y) for x, y in zip(n, nearest[tip])) >= 4:
                pairs.add(edge(a, b))
    taken, moved = set(nearest.values()), {}
    for a, b in sorted(pairs):
        if a in moved or b in moved:
            continue
        n, best = nearest[a], None
        for who, other in ((a, b), (b, a)):
            for axis in range(3):
                side = 1 if who[axis] / step > n[axis] else -1
                if not (who[axis] - other[axis]) * side > 0.0:
                    continue
                to = tuple(c + (side if k == axis else 0) for k, c in enumerate(n))
                far = sum((c / step - q) ** 2 for c, q in zip(who, to))
                if far <= 0.75 and abs(to[axis]) <= LARGEST and to not in taken and (best is None or far < best[0]):
                    best = far, who, to
        if best is not None:
            moved[best[1]] = best[2]
            taken.add(best[2])
    points = {**nearest, **moved}
    return {p: points[r] for p, r in relative.items()}, len(moved)
