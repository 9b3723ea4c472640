#!/usr/bin/env python3
"""Writes the tables of this folder with numpy and with tools that write PLY.

    python3 -m venv venv && venv/bin/pip install numpy plyfile meshio trimesh
    venv/bin/python tests/valid/tables/make.py

They were made with numpy 2, plyfile 1, meshio 5 and trimesh 4. All contain the same five spheres,
or the same five cylinders if the name has `ends`; a name states the tool, the variant, and the columns
besides the points. Every number is exact in an
f32 and in a byte of color. tests/tables.rs reads them.
"""

import os

import meshio
import numpy
import trimesh
from numpy.lib import format as npy
from plyfile import PlyData, PlyElement

SPHERES = numpy.array(
    [
        # x, y, z, radius, red, green, blue
        [0.0, 0.0, -4.0, 0.5, 1.0, 0.0, 0.0],
        [-1.5, 0.25, -5.0, 0.75, 0.0, 1.0, 0.0],
        [1.25, -0.5, -4.5, 0.625, 0.0, 0.0, 1.0],
        [0.5, 1.125, -6.0, 1.0, 1.0, 1.0, 0.0],
        [-0.75, -1.0, -3.5, 0.25, 1.0, 1.0, 1.0],
    ]
)
COLUMNS = {
    "xyz": [0, 1, 2],
    "xyz-radius": [0, 1, 2, 3],
    "xyz-color": [0, 1, 2, 4, 5, 6],
    "xyz-radius-color": [0, 1, 2, 3, 4, 5, 6],
}
HERE = os.path.dirname(os.path.abspath(__file__))


def path(name):
    return os.path.join(HERE, name)


def write_npy():
    kinds = [(order, kind) for kind in ("<f8", ">f8", "<f4", ">f4") for order in "CF"]
    for at, (order, kind) in enumerate(kinds):
        names = list(COLUMNS)
        name = names[(at + at // 4) % 4]
        version = [(1, 0), (2, 0), (3, 0)][at % 3]
        array = numpy.asarray(SPHERES[:, COLUMNS[name]], dtype=kind, order=order)
        size = {"<": "little", ">": "big"}[kind[0]] + kind[1:]
        with open(path(f"numpy-{size}-{order}-v{version[0]}-{name}.npy"), "wb") as file:
            npy.write_array(file, array, version=version)


FIELDS = ["x", "y", "z", "radius", "r", "g", "b"]


def structured(types, **options):
    """Returns the spheres with the given types of their fields, channels of u1 as bytes."""
    dtype = numpy.dtype(types, **options)
    rows = numpy.zeros(len(SPHERES), dtype=dtype)
    for index, name in enumerate(FIELDS):
        if name in rows.dtype.names:
            factor = 255 if dtype[name] == "u1" else 1
            rows[name] = SPHERES[:, index] * factor
    return rows


def write_structured():
    kinds = ["<f8", ">f4", "<f4", ">f8", "u1", "u1", "u1"]
    mixed = structured(list(zip(FIELDS, kinds)))
    numpy.save(path("numpy-structured-xyz-radius-color.npy"), mixed)
    kinds = ["u1", "<f8", "<f2", "<f4"]
    names = ["r", "g", "b"], ["x"], ["y"], ["z"]
    aligned = structured([(n, k) for k, all in zip(kinds, names) for n in all], align=True)
    numpy.save(path("numpy-aligned-xyz-color.npy"), aligned)


def write_npz():
    columns = dict(zip(FIELDS, SPHERES.T))
    numpy.savez(path("numpy-columns-xyz-radius-color.npz"), **columns)
    bytes = {name: (columns[name] * 255).astype("u1") for name in "rgb"}
    numpy.savez_compressed(
        path("numpy-compressed-xyz-radius-color.npz"),
        positions=numpy.asfortranarray(SPHERES[:, :3].astype(">f4")),
        radius=columns["radius"].astype("f2"),
        **bytes,
    )
    numpy.savez(path("numpy-one-xyz-radius.npz"), SPHERES[:, :4])
    numpy.savez_compressed(path("numpy-fields-xyz-color.npz"), rows=structured(
        [(name, "f4") for name in ("x", "y", "z", "r", "g", "b")]
    ))


def write_values():
    """Writes columns for colors by value, and an array with seven unnamed ones."""
    energy = numpy.array([-1.0, -0.25, 0.5, numpy.nan, 2.0])
    kind = numpy.array([3, 1, 4, 1, 5], dtype="i4")
    types = [(name, "f8") for name in FIELDS[:4]] + [("energy", "f4"), ("kind", ">i4"), ("symbol", "U2")]
    rows = numpy.zeros(len(SPHERES), dtype=types)
    for index, name in enumerate(FIELDS[:4]):
        rows[name] = SPHERES[:, index]
    rows["energy"], rows["kind"], rows["symbol"] = energy, kind, "Fe"
    numpy.save(path("values.npy"), rows)
    numpy.savez_compressed(path("values.npz"), positions=SPHERES[:, :4], energy=energy, kind=kind)
    rgba = numpy.column_stack((SPHERES[:, [0, 1, 2, 4, 5, 6]], numpy.ones(len(SPHERES))))
    numpy.save(path("rgba.npy"), rgba)


ENDS = ["x1", "y1", "z1", "x2", "y2", "z2"]


def write_cylinders():
    """Writes cylinders from the points of the spheres to the right, up and back."""
    cylinders = numpy.column_stack((SPHERES[:, :3], SPHERES[:, :3] + [1.0, 0.5, -1.5], SPHERES[:, 3:]))
    numpy.save(path("numpy-ends.npy"), cylinders[:, :6])
    numpy.save(path("numpy-ends-radius.npy"), cylinders[:, :7].astype(">f4"))
    numpy.save(path("numpy-ends-color.npy"), numpy.asfortranarray(cylinders[:, [0, 1, 2, 3, 4, 5, 7, 8, 9]]))
    numpy.save(path("numpy-ends-radius-color.npy"), cylinders)
    names = ENDS + FIELDS[3:]
    types = [(name, "u1" if name in "rgb" else "f4") for name in reversed(names)]
    rows = numpy.zeros(len(cylinders), dtype=types)
    for index, name in enumerate(names):
        rows[name] = cylinders[:, index] * (255 if name in "rgb" else 1)
    numpy.save(path("numpy-structured-ends-radius-color.npy"), rows)
    columns = dict(zip(names, cylinders.T))
    numpy.savez(path("numpy-columns-ends-radius-color.npz"), **columns)
    numpy.savez_compressed(
        path("numpy-compressed-ends-radius.npz"), bonds=cylinders[:, :6], radius=cylinders[:, 6]
    )


def write_plyfile():
    faces = numpy.array(
        [([0, 1, 2], 7), ([2, 3, 4], 8)], dtype=[("vertex_indices", "i4", (3,)), ("group", "u1")]
    )
    faces = PlyElement.describe(faces, "face")
    names = ["x", "y", "z", "radius", "red", "green", "blue"]
    for kind, color in (("f4", "u1"), ("f8", "f4")):
        types = [(n, color if n in names[4:] else kind) for n in names]
        types.insert(3, ("nx", "f4"))
        types.append(("alpha", "u1"))
        rows = numpy.zeros(len(SPHERES), dtype=types)
        for index, name in enumerate(names):
            factor = 255 if index >= 4 and color == "u1" else 1
            rows[name] = SPHERES[:, index] * factor
        vertices = PlyElement.describe(rows, "vertex")
        for encoding in ("ascii", "little", "big"):
            data = PlyData(
                [vertices, faces] if kind == "f4" else [faces, vertices],
                text=encoding == "ascii",
                byte_order=">" if encoding == "big" else "<",
                comments=["five spheres"],
            )
            data.write(path(f"plyfile-{encoding}-{kind}-{color}-xyz-radius-color.ply"))


def write_meshio():
    mesh = meshio.Mesh(
        SPHERES[:, :3], [("triangle", [[0, 1, 2]])], point_data={"radius": SPHERES[:, 3]}
    )
    for binary in (False, True):
        name = "binary" if binary else "ascii"
        mesh.write(path(f"meshio-{name}-xyz-radius.ply"), binary=binary)


def write_trimesh():
    colors = (SPHERES[:, 4:] * 255).astype("u1")
    cloud = trimesh.PointCloud(SPHERES[:, :3], colors=colors)
    cloud.export(path("trimesh-xyz-color.ply"))


if __name__ == "__main__":
    write_npy()
    write_structured()
    write_npz()
    write_values()
    write_cylinders()
    write_plyfile()
    write_meshio()
    write_trimesh()
