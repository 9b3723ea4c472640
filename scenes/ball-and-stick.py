#!/usr/bin/env python3
"""Writes tables/fullerene.xyz and tables/fullerene.csv, atoms and bonds of ball-and-stick.ron.

The molecule is N@C60, buckminsterfullerene with an atom of nitrogen in its middle. The geometry is
idealized: an icosahedron whose corners are cut off, so that the edges of pentagons are 1.45 ångström
long and those between hexagons 1.40 (K. Hedberg et al., Science 254, 410 (1991), measured 1.458 and
1.401).
"""

import itertools
import math
import pathlib

PENTAGON, HEXAGONS = 1.45, 1.40
GOLDEN = (1 + math.sqrt(5)) / 2


def corners(edge):
    """The corners of an icosahedron with this edge."""
    for one, other in itertools.product((-1, 1), (-GOLDEN, GOLDEN)):
        corner = (0.0, one * edge / 2, other * edge / 2)
        for turn in range(3):
            yield corner[turn:] + corner[:turn]


def main():
    edge = PENTAGON + HEXAGONS + PENTAGON
    ends = [
        (a, b)
        for a, b in itertools.permutations(corners(edge), 2)
        if math.isclose(math.dist(a, b), edge)
    ]
    # One atom on each edge, next to its first end.
    part = PENTAGON / edge
    atoms = [tuple(p + part * (q - p) for p, q in zip(a, b)) for a, b in ends]
    bonds = [
        (a, b) for a, b in itertools.combinations(atoms, 2) if math.dist(a, b) < PENTAGON + 0.01
    ]
    tables = pathlib.Path(__file__).resolve().parent / "tables"
    with open(tables / "fullerene.xyz", "w", encoding="utf-8") as file:
        print(len(atoms) + 1, "N@C60, idealized", sep="\n", file=file)
        for element, atom in [("N", (0.0, 0.0, 0.0))] + [("C", atom) for atom in atoms]:
            print(element, *(f"{x:.4f}" for x in atom), file=file)
    with open(tables / "fullerene.csv", "w", encoding="utf-8") as file:
        print("x1,y1,z1,x2,y2,z2,color", file=file)
        for a, b in bonds:
            color = "#d8432f" if math.dist(a, b) < (PENTAGON + HEXAGONS) / 2 else "#b9bdc4"
            print(*(f"{x:.4f}" for x in a + b), color, sep=",", file=file)
    print(f"{len(atoms) + 1} atoms, {len(bonds)} bonds")


if __name__ == "__main__":
    main()
