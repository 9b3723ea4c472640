#!/usr/bin/env python3
"""Writes tables/spruces.csv and tables/birches.csv, the trees of forest.ron.

The trees stand on a square grid, each moved at random within its square; a clearing and a path that winds
through the forest are free of them.
"""

import math
import pathlib
import random

SIDE = 120
STEP = 1.6


def is_free(x, z):
    on_path = abs(x - 6 * math.sin(z / 9) - 2) < 2.2
    in_clearing = math.hypot(x + 9, (z + 12) * 1.3) < 9
    return on_path or in_clearing


def main():
    rng = random.Random(20)
    rows = {"spruces": [], "birches": []}
    for i in range(SIDE):
        for j in range(SIDE):
            x = (i - SIDE / 2 + rng.random()) * STEP
            z = (j - SIDE + 8 + rng.random()) * STEP
            # Birches grow together.
            birch = math.sin(x / 11) + math.sin(z / 7 + 1) + rng.gauss(0, 0.6) > 1.1
            scale = rng.uniform(0.6, 1.3)
            angle = rng.uniform(0, 360)
            if not is_free(x, z):
                row = f"{x:.2f},0,{z:.2f},{scale:.2f},{angle:.0f}"
                rows["birches" if birch else "spruces"].append(row)
    folder = pathlib.Path(__file__).parent / "tables"
    for name, of_kind in rows.items():
        text = "\n".join(["x,y,z,scale,angle", *of_kind, ""])
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
