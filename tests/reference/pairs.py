"""The numbers of paths: pairs in 0..1, a function of the pixel, the sample, the seed and the vertex alone; and
directions that are made from them."""

import numpy as np

from surfaces import dots

# Which pair is for what: the first ones, and those of each vertex.
PLACE, LENS, VERTEX = 0, 1, 2
CHOICE, EMITTER, DIRECTION, ROULETTE = range(4)
OF_VERTEX = 4


def mix(x):
    x = np.asarray(x, np.uint32)
    x = (x ^ (x >> np.uint32(16))) * np.uint32(0x21F0AAAD)
    x = (x ^ (x >> np.uint32(15))) * np.uint32(0xD35A2D97)
    return x ^ (x >> np.uint32(15))


def reversed_bits(x):
    for mask, by in ((0x55555555, 1), (0x33333333, 2), (0x0F0F0F0F, 4), (0x00FF00FF, 8), (0x0000FFFF, 16)):
        mask, by = np.uint32(mask), np.uint32(by)
        x = ((x >> by) & mask) | ((x & mask) << by)
    return x


def owen(x, seed):
    y = reversed_bits(x) + seed
    for k in (0x6C50B47C, 0xB82F1E52, 0xC7AFE638, 0x8D22F6E6):
        y = y ^ y * np.uint32(k)
    return reversed_bits(y)


def sobol(index):
    x = reversed_bits(index)
    for mask, by in ((0x55555555, 1), (0x33333333, 2), (0x0F0F0F0F, 4), (0x00FF00FF, 8), (0x0000FFFF, 16)):
        x = x ^ (x & np.uint32(mask)) << np.uint32(by)
    return x


class Pairs:
    """The pairs of samples of pixels of the whole picture; y counts from the bottom."""

    def __init__(self, x, y, sample, seed):
        x, y = np.asarray(x, np.uint32), np.asarray(y, np.uint32)
        self.pixel = mix(np.uint32(seed) + mix(y + mix(x)))
        self.sample = np.asarray(sample, np.uint32)

    def pair(self, number, rows=slice(None)):
        key = mix(np.asarray(number, np.uint32) + self.pixel[rows])
        index = owen(self.sample[rows], key)
        first = owen(reversed_bits(index), mix(key ^ np.uint32(1)))
        second = owen(sobol(index), mix(key ^ np.uint32(2)))
        return (first + 0.5) * 2.0**-32, (second + 0.5) * 2.0**-32

    def at(self, depth, purpose, rows):
        """Returns a pair of vertices."""
        return self.pair(VERTEX + OF_VERTEX * depth + purpose, rows)


# ---------------------------------------------------------------------------------------------
# Directions
# ---------------------------------------------------------------------------------------------


def circle(v):
    """Returns the cosine and the sine of 2πv."""
    return np.cos(2.0 * np.pi * v), np.sin(2.0 * np.pi * v)


def disc(u, v):
    cos, sin = circle(v)
    return np.sqrt(u) * cos, np.sqrt(u) * sin


def polar(z, v):
    """Returns the unit vectors of a height z, turned by 2πv."""
    radius = np.sqrt(np.maximum(0.0, 1.0 - z * z))
    cos, sin = circle(v)
    return np.stack(np.broadcast_arrays(radius * cos, radius * sin, z), axis=-1)


def frame(n):
    """Returns the axes x, y and z = n of Duff and others."""
    x, y, z = np.moveaxis(n, -1, 0)
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    across = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    return across, np.stack([b, sign + y * y * a, -y], axis=-1), n


def outward(axes, local):
    """Returns vectors of a frame in the world."""
    return sum(local[..., each, None] * axis for each, axis in enumerate(axes))


def inward(axes, vectors):
    """Returns vectors of the world in a frame."""
    return np.stack([dots(vectors, axis) for axis in axes], axis=-1)
