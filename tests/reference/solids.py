"""Solids that are put together from others, for evaluate.py: lists of intervals that are merged."""

import math

import evaluate
import shapes
from evaluate import divide, dot, optional, root, scaled, subtract, variant, vector

COMBINED = ("Union", "Intersection", "Difference")


def operands_of(name, fields):
    return fields["of"] if name != "Difference" else [fields["of"], *fields["minus"]]


def parts_of(geometries):
    """Returns geometries with the parts of solids in place of these."""
    found = []
    for geometry in geometries:
        name, fields = variant(geometry)
        if name in COMBINED:
            found += parts_of(operands_of(name, fields))
        else:
            found += parts_of(fields["geometries"]) if name == "Group" else [geometry]
    return found


def map_operands(change, name, fields):
    """Returns a solid with each of its operands changed."""
    if name == "Difference":
        return {name: {**fields, "of": change(fields["of"]), "minus": list(map(change, fields["minus"]))}}
    return {name: {**fields, "of": list(map(change, fields["of"]))}}


def with_places(solid):
    """Returns a solid whose parts are placed by their own transforms and by those around them in it, its
    groups as unions."""
    return map_operands(operand_with_places, *variant(solid))


def operand_with_places(operand):
    name, fields = variant(operand)
    if name == "Group":
        name, fields = "Union", {"of": fields["geometries"], "transform": fields.get("transform")}
    if name in COMBINED:
        ((name, fields),) = with_places({name: fields}).items()
    return placed({name: fields}, evaluate.transform(optional(fields, "transform", {})))


def placed(solid, matrix):
    """Returns a solid each part of which is mapped by a matrix after its own."""
    name, fields = variant(solid)
    if name not in COMBINED:
        return evaluate.placed(solid, matrix)
    bare = {key: fields[key] for key in fields if key != "transform"}
    return map_operands(lambda operand: placed(operand, matrix), name, bare)


def plane(fields):
    a, n = vector(fields["point"]), vector(fields["normal"])

    def span(o, d):
        above, up = dot(subtract(a, o), n), dot(d, n)
        if up == 0.0:
            return shapes.WHOLE if above >= 0.0 else None
        end = (above / up, 0)
        return (shapes.WHOLE[0], end) if up > 0.0 else (end, shapes.WHOLE[1])

    return span


def sphere(fields):
    c, r = vector(fields["center"]), fields["radius"]

    def span(o, d):
        oc = subtract(o, c)
        a_, b_ = dot(d, d), dot(d, scaled(oc, 2.0))
        discriminant = b_ * b_ - (4.0 * a_) * (dot(oc, oc) - r * r)
        if not discriminant >= 0.0:
            return None
        s = root(discriminant)
        return (divide(-b_ - s, 2.0 * a_), 0), (divide(-b_ + s, 2.0 * a_), 0)

    return span


def simple(name, fields):
    """Returns the function from a ray to the intervals inside one part."""
    if name == "Plane":
        span = plane(fields)
    elif name == "Sphere":
        span = sphere(fields)
    else:
        span, _ = shapes.SOLIDS[name](fields)

    back = evaluate.ray_back(fields["placed"]) if "placed" in fields else lambda o, d: (o, d)

    def intervals(o, d, color):
        ends = [t for t, _ in span(*back(o, d)) or ()]
        pairs = zip(ends[::2], ends[1::2])
        return [((enter, color), (leave, color)) for enter, leave in pairs if enter < leave]

    return intervals


def merged(one, other, keep):
    """Returns the intervals of two lists where `keep` says so of being inside of both."""
    found, begin = [], None

    def end_at(intervals, t):
        return next((end for pair in intervals for end in pair if end[0] == t), None)

    def within(intervals, t):
        """Returns True if the points right behind t are inside."""
        return any(enter[0] <= t < leave[0] for enter, leave in intervals)

    for t in sorted({end[0] for pair in one + other for end in pair}):
        end = end_at(one, t) or end_at(other, t)
        inside = keep(within(one, t), within(other, t))
        if inside and begin is None:
            begin = end
        elif not inside and begin is not None:
            found.append((begin, end))
            begin = None
    return found


KEEPS = {
    "Union": lambda one, other: one or other,
    "Intersection": lambda one, other: one and other,
    "Difference": lambda one, other: one and not other,
}


def intervals_of(name, fields):
    """Returns the function from a ray and a color to the intervals of a solid."""
    if name not in COMBINED:
        inside = simple(name, fields)
        return lambda o, d, around: inside(o, d, fields.get("color") or around)
    operands = [intervals_of(*variant(operand)) for operand in operands_of(name, fields)]

    def intervals(o, d, around):
        own = fields.get("color") or around
        found = operands[0](o, d, own)
        for operand in operands[1:]:
            found = merged(found, operand(o, d, own), KEEPS[name])
        return found

    return intervals


def combined(name, fields):
    """Returns the function from a ray to the t of its hit, which knows its color."""
    intervals = intervals_of(name, fields)

    def first(o, d):
        ends = [end for pair in intervals(o, d, None) for end in pair]
        return min((end for end in ends if 0.0 < end[0] < math.inf), key=lambda end: end[0], default=None)

    def hit(o, d):
        end = first(o, d)
        return None if end is None else end[0]

    hit.color = lambda o, d: first(o, d)[1]
    return hit
