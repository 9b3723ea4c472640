#!/usr/bin/env python3
"""Writes tables/values.npz, the 24,000 points of values.ron.

They lie on a sphere, evenly along a spiral of Fibonacci, at a distance that a sum of spherical
harmonics changes. The column `height` has that change; points in a patch have none.
"""

import math
import pathlib

import numpy

COUNT = 24_000
GOLDEN = math.pi * (3 - math.sqrt(5))


def main():
    index = numpy.arange(COUNT)
    z = 1 - (2 * index + 1) / COUNT
    ring = numpy.sqrt(1 - z * z)
    x, y = ring * numpy.cos(GOLDEN * index), ring * numpy.sin(GOLDEN * index)
    height = 2.2 * x * y * z + 0.9 * (x**4 + y**4 + z**4 - 0.6) + 0.5 * x * (5 * z * z - 1) / 4
    missing = (x - 0.8) ** 2 + (y + 0.55) ** 2 + (z - 0.25) ** 2 < 0.03
    distance = 1 + 0.35 * height
    path = pathlib.Path(__file__).resolve().parent / "tables" / "values.npz"
    numpy.savez_compressed(
        path,
        positions=(numpy.column_stack((x, y, z)) * distance[:, None]).astype("f4"),
        height=numpy.where(missing, numpy.nan, height).astype("f4"),
    )
    print(f"{path}: {COUNT} points, {height.min():.3f} to {height.max():.3f}")


if __name__ == "__main__":
    main()
