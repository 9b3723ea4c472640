#!/usr/bin/env python3
"""Writes tables/sphereflake.npy, the balls of sphereflake.ron: x, y, z and radius as 32-bit numbers.

Every ball carries nine balls of a third of its radius: six around its equator and three above, as in
Eric Haines' Standard Procedural Databases. Five generations are 1 + 9 + ... + 9^5 = 66,430 balls.
"""

import math
import pathlib
import struct

GENERATIONS = 5
# The directions of the nine: angle around the axis and above the equator, in degrees.
AROUND = [(60 * k, 0) for k in range(6)] + [(120 * k + 30, 54.7356) for k in range(3)]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


def flake(center, radius, up, generations):
    """Yields a ball and all that it carries; `up` is its axis."""
    yield (*center, radius)
    if generations == 0:
        return
    side = unit(cross(up, (1.0, 0.0, 0.0) if abs(up[0]) < 0.9 else (0.0, 1.0, 0.0)))
    front = cross(up, side)
    for around, above in AROUND:
        around, above = math.radians(around), math.radians(above)
        across = (math.cos(around) * math.cos(above), math.sin(around) * math.cos(above))
        out = tuple(
            across[0] * s + across[1] * f + math.sin(above) * u for s, f, u in zip(side, front, up)
        )
        small = radius / 3.0
        at = tuple(c + (radius + small) * x for c, x in zip(center, out))
        yield from flake(at, small, out, generations - 1)


def main():
    balls = list(flake((0.0, 0.0, 0.0), 1.0, (0.0, 1.0, 0.0), GENERATIONS))
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(balls)}, 4), }}"
    # The header ends with a line feed at a multiple of 64 bytes.
    header += " " * (-(len(header) + 11) % 64) + "\n"
    path = pathlib.Path(__file__).resolve().parent / "tables" / "sphereflake.npy"
    path.parent.mkdir(exist_ok=True)
    with path.open("wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
        for ball in balls:
            file.write(struct.pack("<4f", *ball))
    print(f"{path}: {len(balls)} balls")


if __name__ == "__main__":
    main()
