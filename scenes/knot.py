#!/usr/bin/env python3
"""Writes meshes/knot.ply, the closed mesh of knot.ron: a fluted tube along a trefoil knot.

The knot winds around a torus: ((2 + cos 3u) cos 2u, (2 + cos 3u) sin 2u, sin 3u). Each vertex has the
curvature of the knot there as a property of its own.
"""

import math
import pathlib
import struct

ALONG = 300
AROUND = 30
RADIUS = 0.46


def point(u):
    r = 2 + math.cos(3 * u)
    return (r * math.cos(2 * u), r * math.sin(2 * u), math.sin(3 * u))


def slope(u):
    r, dr = 2 + math.cos(3 * u), -3 * math.sin(3 * u)
    c, s = math.cos(2 * u), math.sin(2 * u)
    return (dr * c - 2 * r * s, dr * s + 2 * r * c, 3 * math.cos(3 * u))


def bend(u):
    """The second derivative of the knot."""
    r, dr, ddr = 2 + math.cos(3 * u), -3 * math.sin(3 * u), -9 * math.cos(3 * u)
    c, s = math.cos(2 * u), math.sin(2 * u)
    return (ddr * c - 4 * dr * s - 4 * r * c, ddr * s + 4 * dr * c - 4 * r * s, -9 * math.sin(3 * u))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


def section(i):
    """The vertices around the knot at one place, with its curvature."""
    u = 2 * math.pi * i / ALONG
    tangent = unit(slope(u))
    # Away from the middle of the torus: after one round this is the same direction again.
    outward = (math.cos(3 * u) * math.cos(2 * u), math.cos(3 * u) * math.sin(2 * u), math.sin(3 * u))
    side = unit(cross(tangent, outward))
    up = cross(side, tangent)
    speed = math.sqrt(dot(slope(u), slope(u)))
    across = cross(slope(u), bend(u))
    curvature = math.sqrt(dot(across, across)) / speed**3
    for j in range(AROUND):
        v = 2 * math.pi * j / AROUND
        radius = RADIUS * (1 + 0.07 * math.cos(5 * v + 6 * u))
        place = [
            p + radius * (math.cos(v) * a + math.sin(v) * b) for p, a, b in zip(point(u), up, side)
        ]
        yield struct.pack("<4f", *place, curvature)


def faces():
    def vertex(i, j):
        return i % ALONG * AROUND + j % AROUND

    for i in range(ALONG):
        for j in range(AROUND):
            corners = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)]
            yield struct.pack("<B4H", 4, *corners)


def main():
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {ALONG * AROUND}"]
    header += [f"property float {name}" for name in ("x", "y", "z", "curvature")]
    header += [f"element face {ALONG * AROUND}", "property list uchar ushort vertex_indices"]
    body = b"".join(row for i in range(ALONG) for row in section(i)) + b"".join(faces())
    path = pathlib.Path(__file__).resolve().parent / "meshes" / "knot.ply"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes("\n".join([*header, "end_header", ""]).encode() + body)
    print(f"{path}: {ALONG * AROUND} vertices")


if __name__ == "__main__":
    main()
