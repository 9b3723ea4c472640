"""Meshes in PLY and OBJ files, and the colors of their vertices."""

import os

import tables


def read(fields, folder):
    """Returns the fields of a mesh with the contents of its file in place of its name."""
    path = os.path.join(folder, fields["file"])
    vertices, faces = (read_obj if path.endswith(".obj") else read_ply)(path)
    read = {name: value for name, value in fields.items() if name not in ("file", "color_by")}
    read["vertices"] = [[row[axis] for axis in "xyz"] for row in vertices]
    read["triangles"] = [
        [face[0], *face[at : at + 2]] for face in faces for at in range(1, len(face) - 1)
    ]
    by = fields.get("color_by")
    if by:
        # Only vertices with a face count.
        used = sorted({corner for face in faces for corner in face})
        values = [row[by["column"]] for row in vertices]
        color = tables.scale(by, [values[corner] for corner in used])
        read["of_vertices"] = [(value,) for value in values]
        read["color_of"] = lambda mean: tables.channels(color(mean[0]))
    elif fields.get("color") is None and fields.get("material") is None:
        colors = [tables.channels([row[channel] for channel in "rgb"]) for row in vertices]
        read["of_vertices"] = [tuple(linear(channel) for channel in color) for color in colors]
        read["color_of"] = lambda mean: tuple(display(channel) for channel in mean)
    return read


def read_ply(path):
    rows = list(tables.rows_of_ply(path))
    faces = [row for element, row in rows if element == "face"]
    lists = [row.get("vertex_indices", row.get("vertex_index")) for row in faces]
    return [row for element, row in rows if element == "vertex"], lists


def read_obj(path):
    vertices, faces = [], []
    with open(path, encoding="utf-8") as file:
        for words in map(str.split, file):
            if words[:1] == ["v"]:
                vertices.append(dict(zip("xyzrgb", map(float, words[1:]))))
            elif words[:1] == ["f"]:
                faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return vertices, faces


def linear(c):
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def display(light):
    return 12.92 * light if light <= 0.0031308 else 1.055 * light ** (1.0 / 2.4) - 0.055


def color(fields, corners, weights):
    """Returns the color of a point of a triangle whose corners have these weights."""
    a, b, c = (fields["of_vertices"][int(corner)] for corner in corners)
    u, v, w = weights
    return fields["color_of"]([(u * p + v * q) + w * r for p, q, r in zip(a, b, c)])
