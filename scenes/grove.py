"""Writes scenes/parts/crown.csv and scenes/parts/stones.csv, the tables of the parts of grove.ron.

    python3 scenes/grove.py
"""

import math
import os
import random

FOLDER = os.path.join(os.path.dirname(__file__), "parts")


def write(name, rows):
    with open(os.path.join(FOLDER, name), "w", encoding="utf-8", newline="\n") as file:
        file.write("x,y,z,radius,color\n")
        for x, y, z, radius, (r, g, b) in rows:
            file.write(f"{x:.3f},{y:.3f},{z:.3f},{radius:.3f},#{r:02x}{g:02x}{b:02x}\n")


def crown(dice):
    """Leaves on a ball, darker below."""
    for index in range(1200):
        # The golden angle spreads points evenly over a sphere.
        up = 1.0 - 2.0 * (index + 0.5) / 1200
        turn = index * math.pi * (3.0 - math.sqrt(5.0))
        around = math.sqrt(1.0 - up * up)
        far = dice.uniform(0.82, 1.06)
        shade = 0.55 + 0.25 * (up + 1.0) / 2.0 + dice.uniform(-0.1, 0.1)
        color = (int(110 * shade), int(190 * shade), int(60 * shade))
        x, y, z = around * math.cos(turn), up, around * math.sin(turn)
        yield 1.25 * far * x, 2.75 + 1.05 * far * y, 1.25 * far * z, dice.uniform(0.07, 0.13), color


def stones(dice):
    """A ring of stones."""
    for index in range(26):
        turn = index * 2.0 * math.pi / 26 + dice.uniform(-0.08, 0.08)
        radius = dice.uniform(0.1, 0.24)
        far = 2.6 + dice.uniform(-0.15, 0.15)
        gray = dice.randint(120, 175)
        color = (gray, gray - 4, gray - 12)
        yield far * math.cos(turn), 0.4 * radius, far * math.sin(turn), radius, color


def main():
    dice = random.Random(22)
    write("crown.csv", crown(dice))
    write("stones.csv", stones(dice))


if __name__ == "__main__":
    main()
