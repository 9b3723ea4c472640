#!/usr/bin/env python3
"""Writes jewels-paths.ron: the planes of the facets of its gems.

    python3 scenes/jewels.py > scenes/jewels-paths.ron
    strahl fmt scenes/jewels-paths.ron

The angles of crown and pavilion are those of a brilliant, 34.5 and 40.75 degrees.
"""

import math


def v(*a):
    return "(" + ", ".join(f"{round(x, 4):g}" for x in a) + ")"


CROWN = math.radians(34.5)
PAVILION = math.radians(40.75)


def around(count, offset):
    """The cosines and sines of directions around the axis of a gem."""
    turns = [2 * math.pi * (i + offset) / count for i in range(count)]
    return [(math.cos(turn), math.sin(turn)) for turn in turns]


def gem(color, ior, facets, at, axis, angle, size):
    """A gem of planes, whose girdle has the radius `size`. The ball comes first: rays that miss it miss the gem."""
    slope, steep = math.sin(CROWN), math.sin(PAVILION)
    parts = ["Sphere(center: (0, 0, 0), radius: 1.1)", f"Plane(point: {v(0, 0.34, 0)}, normal: (0, 1, 0))"]
    parts += [
        f"Plane(point: {v(c, 0.03, s)}, normal: {v(slope * c, math.cos(CROWN), slope * s)})"
        for c, s in around(facets, 0.5)
    ]
    parts += [
        f"Plane(point: {v(c, -0.03, s)}, normal: {v(steep * c, -math.cos(PAVILION), steep * s)})"
        for c, s in around(facets, 0.5)
    ]
    parts += [f"Plane(point: {v(0.99 * c, 0, 0.99 * s)}, normal: {v(c, 0, s)})" for c, s in around(facets, 0)]
    listed = ",\n                ".join(parts)
    return f"""        Intersection(
            material: Glass(ior: {ior}, color: "{color}"),
            transform: (scale: {v(size, size, size)}, rotate: (axis: {v(*axis)}, angle: {angle}), translate: {v(*at)}),
            of: [
                {listed},
            ],
        ),"""


print("""// A jeweller's table: rough gold, gems, pearls and a frosted ball on a checkered cloth, through a thin lens.
(
    image: (width: 640, height: 360),
    camera: Perspective(
        eye: (0.2, 1.5, 4.4),
        look_at: (0, 0.28, 0),
        fov: 24,
        aperture: 0.09,
        focus_at: (0, 0.4, 0.25),
    ),
    background: "#2a2024",
    lighting: Path(samples: 512, noise: 0.04, max_depth: 24),
    lights: [
        Environment(
            sky: (zenith: "#b8c8e4", horizon: "#9aa2ac", ground: "#50483f"),
            intensity: 0.7,
            visible: false,
        ),
    ],
    materials: {
        "gold": Metal(color: "#ffcf70", roughness: 0.22),
        "silver": Metal(color: "#e8e6e1", roughness: 0.12),
        "pearl": Plastic(color: "#f4ebe0", roughness: 0.18),
    },
    geometries: [
        Plane(
            point: (0, 0, 0),
            normal: (0, 1, 0),
            material: Matte(texture: Checker(even: "#7d3a3a", odd: "#6a2c30", size: 0.16)),
        ),
        // A large soft lamp to the left, and a small one behind.
        Rectangle(
            corner: (-3.2, 2.2, -1),
            edge_u: (0, 0, 2.4),
            edge_v: (1.4, 1.2, 0),
            material: Emissive(color: "#fff0dc", intensity: 12),
        ),
        Rectangle(
            corner: (1.2, 2.6, -2.6),
            edge_u: (1.2, 0, 0.3),
            edge_v: (0, 0.7, 0.4),
            material: Emissive(color: "#cfe0ff", intensity: 16),
        ),
        // The ring, with a stone.
        Torus(center: (-0.02, 0.43, -0.05), axis: (0.35, 0.12, 1), radius: 0.37, tube_radius: 0.06, material: Named("gold")),
        Cone(from: (-0.03, 0.8, -0.055), to: (-0.032, 0.95, -0.07), radius: 0.05, top_radius: 0.13, material: Named("gold")),""")
print(gem("#ffffff", 2.2, 8, (-0.034, 0.985, -0.075), (1, 0.2, 0), 8, 0.2))
print(gem("#39c083", 1.6, 8, (0.92, 0.195, 0.45), (1, 0, -0.6), 150, 0.27))
print(gem("#d8343e", 1.77, 6, (-0.88, 0.175, 0.62), (0.9, 0, 0.35), 148, 0.22))
print("""        Sphere(center: (0.62, 0.3, -0.65), radius: 0.3, material: Named("silver")),
        Sphere(center: (-1.0, 0.34, -0.6), radius: 0.34, material: Glass(ior: 1.5, roughness: 0.35)),""")
for i in range(9):
    radius = 0.07 + 0.012 * (i % 3 == 1)
    center = v(-0.55 + i * 0.155, radius, 0.78 + 0.16 * math.sin(i * 0.9))
    print(f'        Sphere(center: {center}, radius: {radius:g}, material: Named("pearl")),')
print("""    ],
)""")
