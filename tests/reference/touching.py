"""Random geometries that touch others: faces, edges and vertices are shared, solids stand on planes or in
one another, and copies stand in the place of their originals."""

AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


def moved(p, by, along):
    return [x + by * y for x, y in zip(p, along)]


class Touching:
    """A generator for a source of random numbers. Lengths are multiples of a unit, which may round."""

    def __init__(self, source):
        self.random = source
        self.unit = source.choice((0.25, 0.25, 0.1, 1.0 / 3.0, source.uniform(0.1, 0.3)))
        self.points = []

    def chance(self, p):
        return self.random.random() < p

    def length(self, most=6):
        return self.unit * self.random.randint(1, most)

    def place(self):
        return [self.unit * self.random.randint(-6, 6) for _ in range(3)]

    def axis(self):
        return self.random.choice(AXES)

    def first(self):
        """Returns a geometry that others can touch."""
        kinds = ["Box", "Box", "Sphere", "Plane", "Cylinder", "Capsule", "Terrain", "Cup", "Bricks", "Rectangle"]
        kind = self.random.choice(kinds)
        place = self.place()
        if kind == "Box":
            return self.box(place)
        if kind == "Sphere":
            return kind, {"center": place, "radius": self.length()}
        if kind == "Plane":
            return kind, {"point": place, "normal": self.axis()}
        if kind in ("Cylinder", "Capsule"):
            end = moved(place, self.length(), self.axis())
            return kind, {"from": place, "to": end, "radius": self.length(3)}
        if kind == "Terrain":
            return self.terrain(place)
        if kind == "Cup":
            return self.cup(place)
        if kind == "Rectangle":
            u, v = self.random.sample(AXES, 2)
            edges = {"edge_u": moved([0, 0, 0], self.length(), u), "edge_v": moved([0, 0, 0], self.length(), v)}
            return kind, {"corner": place} | edges
        name, box = self.box(place)
        other = self.beside_box(box)
        while other[0] != name:
            other = self.beside_box(box)
        return "Union", {"of": [{name: box}, dict([other])]}

    def box(self, low):
        return "Box", {"min": low, "max": [x + self.length() for x in low]}

    def terrain(self, place):
        """Returns a mesh of triangles over a square."""
        count = self.random.choice((2, 3, 4))
        rows = [(x, z) for z in range(count) for x in range(count)]
        step = self.length(4)
        vertices = [moved(place, step, [x, self.random.choice((0, 0.3, 0.5, 1)), z]) for x, z in rows]
        triangles = []
        for at in (z * count + x for z in range(count - 1) for x in range(count - 1)):
            triangles += [[at, at + count, at + 1], [at + 1, at + count, at + count + 1]]
        self.points += vertices
        return "Mesh", {"vertices": vertices, "triangles": triangles, "smooth": self.chance(0.3)}

    def cup(self, place):
        tall, radius, wall = self.length() + self.unit, self.length(3) + self.unit, self.unit / 2.0
        base, top = moved(place, wall, AXES[1]), moved(place, tall, AXES[1])
        outside = {"from": place, "to": top, "radius": radius}
        inside = {"from": base, "to": moved(top, wall, AXES[1]), "radius": radius - wall}
        return "Difference", {"of": {"Cylinder": outside}, "minus": [{"Cylinder": inside}]}

    def beside(self, kind, fields):
        """Returns a geometry that touches another one."""
        if self.chance(0.2):
            return kind, fields
        if kind == "Box":
            return self.beside_box(fields)
        if kind == "Sphere":
            return self.beside_ball(fields["center"], fields["radius"])
        if kind in ("Plane", "Disc"):
            return self.on_plane(fields.get("point", fields.get("center")), fields["normal"])
        if kind in ("Cylinder", "Capsule"):
            return self.beside_tube(kind, fields)
        if kind == "Rectangle":
            return self.beside_rectangle(fields)
        if kind == "Mesh":
            a, b, _ = self.random.choice(fields["triangles"])
            corners = [fields["vertices"][int(corner)] for corner in (a, b)]
            far = moved(corners[0], self.random.uniform(0.5, 2.0), self.axis())
            return "Triangle", dict(zip("abc", [*corners, moved(far, self.unit, [0.3, 0.1, 0.2])]))
        if kind == "Difference":
            water = dict(fields["minus"][0]["Cylinder"])
            low, high = water["from"], water["to"]
            water["to"] = moved(low, self.random.choice((0.5, 0.75)), [b - a for a, b in zip(low, high)])
            if self.chance(0.3):
                return "Plane", {"point": fields["of"]["Cylinder"]["from"], "normal": [0, 1, 0]}
            return "Cylinder", water
        if kind == "Union" and "Box" in fields["of"][0]:
            return self.beside_box(fields["of"][0]["Box"])
        return kind, fields

    def beside_box(self, fields):
        low, high = fields["min"], fields["max"]
        wide = [b - a for a, b in zip(low, high)]
        axis = self.random.randrange(3)
        corner = [self.random.choice(ends) for ends in zip(low, high)]
        self.points += [low, high, corner, moved(low, wide[axis], AXES[axis])]
        kind = self.random.choice(["Next", "Next", "Next", "Edge", "Corner", "On", "Floor", "Ball", "Lid"])
        up = [list(low), list(high)]
        if kind in ("Next", "Edge", "Corner"):
            count = ["Next", "Edge", "Corner"].index(kind) + 1
            for each in ([axis] + [other for other in range(3) if other != axis])[:count]:
                up[0][each], up[1][each] = high[each], high[each] + self.random.choice((wide[each], self.length()))
            return "Box", {"min": up[0], "max": up[1]}
        if kind == "On":
            inner = [0.25 * w for w in wide]
            for each in range(3):
                up[0][each], up[1][each] = low[each] + inner[each], high[each] - inner[each]
            up[0][axis], up[1][axis] = high[axis], high[axis] + self.length(3)
            return "Box", {"min": up[0], "max": up[1]}
        if kind == "Floor":
            return "Plane", {"point": list(self.random.choice((low, high))), "normal": AXES[axis]}
        middle = [(a + b) / 2.0 for a, b in zip(low, high)]
        middle[axis] = high[axis]
        if kind == "Ball":
            radius = self.length(3)
            return "Sphere", {"center": moved(middle, radius, AXES[axis]), "radius": radius}
        return "Disc", {"center": middle, "normal": AXES[axis], "radius": self.length(4)}

    def beside_ball(self, center, radius):
        axis = self.axis()
        top = moved(center, radius, axis)
        self.points.append(top)
        kind = self.random.choice(["Ball", "Plane", "Capsule", "Union", "Water", "Disc"])
        if kind == "Ball":
            other = self.length()
            return "Sphere", {"center": moved(top, other, axis), "radius": other}
        if kind == "Plane":
            return "Plane", {"point": top, "normal": axis}
        if kind == "Capsule":
            return "Capsule", {"from": center, "to": moved(center, self.length(), axis), "radius": radius}
        if kind == "Disc":
            return "Disc", {"center": center, "normal": axis, "radius": radius}
        ball = {"Sphere": {"center": center, "radius": radius}}
        if kind == "Water":
            half = {"Plane": {"point": moved(center, 0.25 * radius, axis), "normal": axis}}
            return "Intersection", {"of": [ball, half]}
        return "Union", {"of": [ball, {"Sphere": {"center": top, "radius": self.length()}}]}

    def on_plane(self, point, normal):
        if sorted(map(abs, normal)) != [0, 0, 1] or min(normal) < 0:
            return "Plane", {"point": point, "normal": self.axis()}
        others = [axis for axis in AXES if axis != normal]
        at = point
        for axis in others:
            at = moved(at, self.length() - 2 * self.unit, axis)
        self.points.append(at)
        kind = self.random.choice(["Box", "Ball", "Cylinder", "Disc", "Valley", "Cup"])
        if kind == "Box":
            return self.box(at)
        if kind == "Ball":
            radius = self.length(4)
            return "Sphere", {"center": moved(at, radius, normal), "radius": radius}
        if kind == "Cylinder":
            return "Cylinder", {"from": at, "to": moved(at, self.length(), normal), "radius": self.length(3)}
        if kind == "Disc":
            return "Disc", {"center": at, "normal": normal, "radius": self.length()}
        if kind == "Valley":
            return "Plane", {"point": at, "normal": moved(others[0], self.random.choice((0, 0.5, 1, -2)), normal)}
        return self.cup(at)

    def beside_tube(self, name, fields):
        a, b, radius = fields["from"], fields["to"], fields["radius"]
        along = [y - x for x, y in zip(a, b)]
        kind = self.random.choice(["Next", "Cap", "Ball", "Capsule", "Cone", "Floor"])
        self.points += [a, b]
        if kind == "Next":
            return name, {"from": b, "to": moved(b, 1.0, along), "radius": radius}
        if kind == "Cap":
            return "Disc", {"center": b, "normal": along, "radius": self.random.choice((radius, 0.5 * radius))}
        if kind == "Ball":
            return "Sphere", {"center": b, "radius": radius}
        if kind == "Capsule":
            return "Capsule", {"from": a, "to": b, "radius": radius}
        if kind == "Cone":
            return "Cone", {"from": b, "to": moved(b, 1.0, along), "radius": radius}
        return "Plane", {"point": a, "normal": along}

    def beside_rectangle(self, fields):
        a, u, v = fields["corner"], fields["edge_u"], fields["edge_v"]
        self.points += [a, moved(a, 1.0, u)]
        kind = self.random.choice(["Next", "Wall", "Box"])
        if kind == "Next":
            return "Rectangle", {"corner": moved(a, 1.0, u), "edge_u": u, "edge_v": v}
        across = [abs(x + y) < 1e-9 for x, y in zip(u, v)]
        wall = [self.length() * is_across for is_across in across]
        if kind == "Wall":
            return "Rectangle", {"corner": a, "edge_u": wall, "edge_v": v}
        return "Box", {"min": a, "max": [x + y + z + w for x, y, z, w in zip(a, u, v, wall)]}

    def sun(self):
        """Returns the direction of a sun that is high or low, or grazes."""
        low = self.random.choice((1.0, 0.3, 1e-2, 1e-5))
        across = [self.random.gauss(0.0, 1.0), -low, 1]
        return self.random.choice(([-1, -2, -1], [0, -1, 0], [-0.8, -low, 0.3], across))

    def turned(self):
        """Returns the matrix of a group that turns by a few digits, stretches, moves and is of another size."""
        c, s = self.random.choice(((0.6, 0.8), (0.28, -0.96), (0.8660254037844386, 0.5)))
        by = [self.random.choice((1.0, 1.0, 2.0, 0.3)) for _ in range(3)]
        far = self.random.choice((0.0, 1.0, 1.0, 100.0))
        rows = [[c, -s, 0.0], [0.6 * s, 0.6 * c, -0.8], [0.8 * s, 0.8 * c, 0.6]]
        size = self.random.choice((1.0, 1.0, 1e-6, 1e3, 1e6))
        rows = [[x * y for x, y in zip(row, by)] + [far * self.random.uniform(-0.1, 0.1)] for row in rows]
        return [[size * x for x in row] for row in rows]
