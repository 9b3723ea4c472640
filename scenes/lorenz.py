#!/usr/bin/env python3
"""Writes tables/lorenz.ply, the 100,000 particles of lorenz.ron.

They lie on one path of the equations of E. N. Lorenz, J. Atmos. Sci. 20, 130 (1963):
x' = 10(y - x), y' = x(28 - z) - y, z' = xy - 8z/3. Positions are in hundredths, as 16-bit numbers;
the color is that of the speed.
"""

import math
import pathlib
import struct

COUNT = 100_000
STEP = 0.0015
SCALE = 100
# Colors from slow to fast.
RAMP = [(44, 62, 130), (38, 130, 170), (120, 190, 140), (245, 200, 92), (232, 110, 60), (168, 34, 60)]


def slope(p):
    x, y, z = p
    return (10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z)


def moved(p, by, d):
    return tuple(a + by * b for a, b in zip(p, d))


def step(p):
    """The classical method of Runge and Kutta."""
    a = slope(p)
    b = slope(moved(p, STEP / 2, a))
    c = slope(moved(p, STEP / 2, b))
    d = slope(moved(p, STEP, c))
    mean = tuple((i + 2 * j + 2 * k + l) / 6 for i, j, k, l in zip(a, b, c, d))
    return moved(p, STEP, mean)


def color(speed):
    place = min(max((speed - 8.0) / 190.0, 0.0), 1.0) ** 0.7 * (len(RAMP) - 1)
    first = min(int(place), len(RAMP) - 2)
    part = place - first
    return tuple(round(a + part * (b - a)) for a, b in zip(RAMP[first], RAMP[first + 1]))


def main():
    p = (1.0, 1.0, 20.0)
    for _ in range(4000):
        p = step(p)
    rows = bytearray()
    for _ in range(COUNT):
        x, y, z = (round(SCALE * value) for value in p)
        speed = math.sqrt(sum(value * value for value in slope(p)))
        rows += struct.pack("<3h3B", x, y, z, *color(speed))
        p = step(p)
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {COUNT}"]
    header += [f"property short {name}" for name in "xyz"]
    header += [f"property uchar {name}" for name in ("red", "green", "blue")]
    path = pathlib.Path(__file__).resolve().parent / "tables" / "lorenz.ply"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes("\n".join([*header, "end_header", ""]).encode() + rows)
    print(f"{path}: {COUNT} particles")


if __name__ == "__main__":
    main()
