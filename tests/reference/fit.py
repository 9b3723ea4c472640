"""The camera that a `Fit` becomes, found by bisection.

The renderer solves equations of support functions. This bisects the depth of the eye and, for each
depth, its place sideways, with the slopes of silhouettes by other formulas: the tangents of a
circle by angles, those of a disc by a quadratic equation.
"""

import math

import evaluate as e

STEPS = 200


def slope_of_sphere(fields, eye, axis, w):
    """Returns the largest slope, towards `axis`, of a ray from the eye that touches a sphere."""
    center = e.subtract(e.vector(fields["center"]), eye)
    across, depth = e.dot(center, axis), -e.dot(center, w)
    distance = math.hypot(across, depth)
    if distance <= fields["radius"]:
        return math.inf
    angle = math.atan2(across, depth) + math.asin(fields["radius"] / distance)
    return math.tan(angle) if angle < math.pi / 2 else math.inf


def rim(fields):
    """Returns the center of a disc and two perpendicular radii."""
    n = e.unit(e.vector(fields["normal"]))
    other = min(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), key=lambda a: abs(e.dot(a, n)))
    p = e.unit(e.cross(n, other))
    q = e.cross(n, p)
    r = fields["radius"]
    return e.vector(fields["center"]), e.scaled(p, r), e.scaled(q, r)


def slope_of_disc(fields, eye, axis, w):
    """Returns the largest slope of a ray to the rim, the larger root m of `(A - m·D)² = |B - m·E|²`,
    where A and D are the place of the center across and in depth, B and E those of two radii."""
    center, p, q = rim(fields)
    center = e.subtract(center, eye)
    across = [e.dot(x, axis) for x in (center, p, q)]
    depth = [-e.dot(x, w) for x in (center, p, q)]
    if depth[0] <= math.hypot(depth[1], depth[2]):
        return math.inf
    a = depth[0] ** 2 - depth[1] ** 2 - depth[2] ** 2
    b = across[0] * depth[0] - across[1] * depth[1] - across[2] * depth[2]
    c = across[0] ** 2 - across[1] ** 2 - across[2] ** 2
    return (b + math.sqrt(max(b * b - a * c, 0.0))) / a


SLOPES = {"Sphere": slope_of_sphere, "Disc": slope_of_disc}


def far_of(name, fields, axis):
    """Returns the largest coordinate of a shape along an axis."""
    if name == "Sphere":
        return e.dot(e.vector(fields["center"]), axis) + fields["radius"]
    center, p, q = rim(fields)
    return e.dot(center, axis) + math.hypot(e.dot(p, axis), e.dot(q, axis))


def bisect(low, high, is_low):
    for _ in range(STEPS):
        middle = (low + high) / 2.0
        low, high = (middle, high) if is_low(middle) else (low, middle)
    return (low + high) / 2.0


def explicit(camera, geometries, width, height):
    """Returns a camera with an eye in place of a `Fit`; any other camera as it is."""
    name, fields = e.variant(camera)
    if name != "Fit":
        return camera
    shapes = [e.variant(geometry) for geometry in geometries]
    shapes = [(kind, shape) for kind, shape in shapes if kind != "Plane"]
    gaze = e.negated(e.vector(e.optional(fields, "from", (1.0, 0.6, 1.0))))
    up = e.optional(fields, "up", (0.0, 1.0, 0.0))
    _, u, v, w, _, _ = e.basis({"eye": (0.0, 0.0, 0.0), "gaze": gaze, "up": up})
    filled = 1.0 - 2.0 * e.optional(fields, "margin", 0.05)
    projection = e.optional(fields, "projection", {"Perspective": {"fov": 35.0}})
    kind, projection = e.variant(projection)
    sides = [[max(far_of(*shape, s) for shape in shapes) for s in (a, e.negated(a))] for a in (u, v, w)]
    middle = [(one - other) / 2.0 for one, other in sides]
    size = max(one + other for one, other in sides)

    def place(a, b, c):
        return e.add(e.add(e.scaled(u, a), e.scaled(v, b)), e.scaled(w, c))

    if kind == "Orthographic":
        (left, right), (bottom, top) = sides[:2]
        pixel = max((left + right) / width, (bottom + top) / height) / filled
        eye = place(middle[0], middle[1], sides[2][0] + pixel * height)
        scale = pixel * (height - 1.0 if height > 1.0 else 1.0)
        return {"Orthographic": {"eye": eye, "gaze": gaze, "up": up, "scale": scale}}

    tangent = math.tan(projection["fov"] / 2.0 * (math.pi / 180.0)) * filled
    most = (tangent * width / height, tangent)

    def slope(eye, axis):
        return max(SLOPES[kind](shape, eye, axis, w) for kind, shape in shapes)

    def centered(c):
        """Returns the eye at a depth with equal margins, and how much of the picture is filled."""

        def sideways(axis, eye_at, middle):
            at = bisect(
                middle - 2 * size,
                middle + 2 * size,
                lambda x: slope(eye_at(x), axis) > slope(eye_at(x), e.negated(axis)),
            )
            return at, max(slope(eye_at(at), axis), slope(eye_at(at), e.negated(axis)))

        a, across = sideways(u, lambda x: place(x, middle[1], c), middle[0])
        b, upwards = sideways(v, lambda x: place(middle[0], x, c), middle[1])
        return place(a, b, c), max(across / most[0], upwards / most[1])

    nearest = sides[2][0]
    far = size * (2.0 + 2.0 / min(most))
    depth = bisect(nearest, nearest + far, lambda c: centered(c)[1] > 1.0)
    eye = centered(depth)[0]
    return {"Perspective": {"eye": eye, "gaze": gaze, "up": up, "fov": projection["fov"]}}
