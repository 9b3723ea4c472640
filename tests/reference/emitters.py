"""What paths aim at: lights, in their order, and then the faces that shine, by their numbers.

An emitter has the weight of its choice at points, and it is aimed at by a pair of numbers.
"""

import math

import numpy as np

import shapes
from evaluate import optional, variant
from light import BEFORE_LIGHT, lin
from pairs import circle, disc, frame, outward, polar
from surfaces import dots, units

# The heights above and below the horizon over which the light of a sky is averaged.
HEIGHTS = (np.arange(64) + 0.5) / 64.0


class Aimed:
    """The directions to an emitter and its light along them, the ways of shadow rays with their limit, and the
    density of the directions; None without a size. Rays that are not aimed may find it, too, or not."""

    def __init__(self, l, light, way, limit, density=None, is_found=False):
        self.l, self.light, self.way, self.limit = l, light, way, limit
        self.density, self.is_found = density, is_found


# ---------------------------------------------------------------------------------------------
# Directions within a cone
# ---------------------------------------------------------------------------------------------


def cone_density(sin2):
    return (1.0 + np.sqrt(1.0 - sin2)) / (2.0 * np.pi * sin2)


def cone_sample(axis, sin2, u, v):
    k = u * sin2 / (1.0 + np.sqrt(1.0 - sin2))
    radius = np.sqrt(k * (2.0 - k))
    cos, sin = circle(v)
    return outward(frame(axis), np.stack([radius * cos, radius * sin, 1.0 - k], axis=-1))


def to_ball(to, radius, l):
    """Returns the distances along unit vectors."""
    along = dots(to, l)
    across = to - along[:, None] * l
    return along - np.sqrt(np.maximum(0.0, radius * radius - dots(across, across)))


# ---------------------------------------------------------------------------------------------
# Lights
# ---------------------------------------------------------------------------------------------


# The number of emitters with a place up to which there is no tree.
FEW = 32


class Light:
    """A light, which may have a size."""

    def has_place(self):
        return self.name != "Directional" and optional(self.light[1], "falloff", "InverseSquare") == "InverseSquare"

    def place(self):
        return self.center

    def power(self):
        fields = self.light[1]
        return np.pi * float(optional(fields, "intensity", 1.0)) * lin(optional(fields, "color", "#ffffff")).max()

    def __init__(self, world, light):
        self.world, self.light = world, light
        self.name, fields = light
        self.shadows = optional(fields, "shadows", True)
        self.radius = float(optional(fields, "radius", 0.0))
        self.sin2 = math.sin(math.radians(float(optional(fields, "angle", 0.0))) / 2.0) ** 2
        if self.name == "Directional":
            self.axis = units(-np.array(fields["direction"], float))
            self.has_size = self.sin2 > 0.0
        else:
            self.center = np.array(fields["position"], float)
            self.has_size = self.radius > 0.0

    def arriving(self, p):
        return self.world.unshadowed(self.light, p, np.broadcast_to([0.0, 0.0, 1.0], p.shape))

    def is_inside(self, p):
        if self.name == "Directional":
            return np.zeros(len(p), bool)
        to = self.center - p
        return (dots(to, to) <= self.radius**2) & self.has_size

    def weight(self, p):
        return np.where(self.is_inside(p), 0.0, np.pi * self.arriving(p)[0].max(axis=1))

    def cone(self, p):
        """Returns the axes and the squared sines of the directions in which it is seen."""
        if self.name == "Directional":
            return np.broadcast_to(self.axis, p.shape), np.full(len(p), self.sin2)
        to = self.center - p
        return units(to), np.minimum(1.0, self.radius**2 / dots(to, to))

    def radiance(self, p):
        """Returns the light of the body that is seen from points."""
        light = self.arriving(p)[0]
        light = light / self.cone(p)[1][:, None]
        return np.where(self.is_inside(p)[:, None], 0.0, light)

    def aim(self, start, u, v):
        p = start.p
        if not self.has_size:
            light, l, way, limit = self.arriving(p)
            return Aimed(l, light, way, limit)
        axis, sin2 = self.cone(p)
        l = cone_sample(axis, sin2, u, v)
        way, limit = l, math.inf
        if self.name != "Directional":
            way, limit = l * to_ball(self.center - p, self.radius, l)[:, None], BEFORE_LIGHT
        way = way if self.shadows else None
        return Aimed(l, self.radiance(p), way, limit, self.density(p), self.shadows)

    def density(self, p):
        return cone_density(self.cone(p)[1])

    def is_passed(self, o, d, distance):
        """Returns which rays pass it before a distance."""
        l = units(d)
        if self.name == "Directional":
            across = np.cross(l, self.axis)
            return np.isinf(distance) & (dots(l, self.axis[None]) > 0.0) & (dots(across, across) <= self.sin2)
        to = self.center - o
        along = dots(to, l)
        across = to - along[:, None] * l
        half = self.radius**2 - dots(across, across)
        reaches = along - np.sqrt(np.maximum(0.0, half)) < distance
        return ~self.is_inside(o) & (along > 0.0) & (half >= 0.0) & reaches


class Picture:
    """A picture of all directions: its first row is the zenith, its middle lies to the front."""

    def __init__(self, fields):
        self.texels = fields["texels"]
        self.height, self.width, _ = self.texels.shape
        self.up = units(np.array(optional(fields, "up", (0.0, 1.0, 0.0)), float))
        front = np.array([0.0, 0.0, -1.0]) + self.up[2] * self.up
        front = units(front) if front @ front > 1e-24 else np.array([0.0, np.sign(self.up[2]), 0.0])
        turn = math.radians(float(optional(fields, "rotation", 0.0)))
        self.front = front * math.cos(turn) + np.cross(self.up, front) * math.sin(turn)
        self.right = np.cross(self.front, self.up)
        self.heights = np.cos(np.pi * np.arange(self.height + 1) / self.height)
        brightest = self.texels.max(axis=2)
        above, below = np.vstack([brightest[:1], brightest[:-1]]), np.vstack([brightest[1:], brightest[-1:]])
        means = above / 8.0 + brightest * 6.0 / 8.0 + below / 8.0
        means = np.roll(means, 1, axis=1) / 8.0 + means * 6.0 / 8.0 + np.roll(means, -1, axis=1) / 8.0
        self.angles = 2.0 * np.pi / self.width * (self.heights[:-1] - self.heights[1:])
        self.sums = np.cumsum(means * self.angles[:, None])

    def place(self, l):
        around = np.arctan2(l @ self.right, l @ self.front)
        down = np.arccos(np.clip(l @ self.up, -1.0, 1.0))
        return (0.5 + around / (2.0 * np.pi)) * self.width, down / np.pi * self.height

    def at(self, l):
        x, y = (each - 0.5 for each in self.place(l))
        left, top = np.floor(x).astype(int), np.floor(y).astype(int)
        across, down = (x - left)[:, None], (y - top)[:, None]
        columns = [left % self.width, (left + 1) % self.width]
        rows = [np.clip(each, 0, self.height - 1) for each in (top, top + 1)]
        above, below = ((1.0 - across) * self.texels[row, columns[0]] + across * self.texels[row, columns[1]] for row in rows)
        return (1.0 - down) * above + down * below

    def density_at(self, pixel):
        before = np.where(pixel > 0, self.sums[pixel - 1], 0.0)
        return (self.sums[pixel] - before) / (self.sums[-1] * self.angles[pixel // self.width])

    def density(self, l):
        x, y = self.place(l)
        column = np.minimum(x.astype(int), self.width - 1)
        return self.density_at(np.minimum(y.astype(int), self.height - 1) * self.width + column)

    def aim(self, u, v):
        target = u * self.sums[-1]
        pixel = np.minimum(np.searchsorted(self.sums, target, side="right"), len(self.sums) - 1)
        before = np.where(pixel > 0, self.sums[pixel - 1], 0.0)
        part = np.clip((target - before) / (self.sums[pixel] - before), 0.0, 1.0)
        row, column = pixel // self.width, pixel % self.width
        height = self.heights[row] + (self.heights[row + 1] - self.heights[row]) * part
        beside = np.sqrt(np.maximum(0.0, 1.0 - height * height))
        turn = 2.0 * np.pi * ((column + v) / self.width) - np.pi
        level = np.sin(turn)[:, None] * self.right + np.cos(turn)[:, None] * self.front
        return units(height[:, None] * self.up + beside[:, None] * level), self.density_at(pixel)


class Environment:
    def has_place(self):
        return False

    def __init__(self, fields):
        self.intensity = float(optional(fields, "intensity", 1.0))
        self.color = lin(optional(fields, "color", "#ffffff"))
        self.sky, self.is_visible = fields.get("sky"), optional(fields, "visible", True)
        self.picture = Picture(fields) if "texels" in fields else None
        self.up = units(np.array(optional(fields, "up", (0.0, 1.0, 0.0)), float))
        if self.picture is None:
            self.mean = self.at(np.concatenate([HEIGHTS, -HEIGHTS])).max(axis=1).mean()
        else:
            self.mean = self.intensity * self.picture.sums[-1] / (4.0 * np.pi)

    def at(self, height):
        """Returns the light from directions with these cosines to the zenith."""
        if self.sky is None:
            return np.broadcast_to(self.intensity * self.color, (len(height), 3))
        zenith, horizon, ground = (lin(self.sky[name]) for name in ("zenith", "horizon", "ground"))
        end = np.where(height[:, None] > 0.0, zenith, ground)
        return self.intensity * (horizon + (end - horizon) * np.abs(height)[:, None])

    def radiance(self, l):
        if self.picture is not None:
            return self.intensity * self.picture.at(l)
        return self.at(l @ self.up)

    def weight(self, p):
        return np.full(len(p), np.pi * self.mean)

    def aim(self, start, u, v):
        if self.picture is None:
            l = polar(1.0 - 2.0 * u, v)
            density = self.density_of(l)
        else:
            l, density = self.picture.aim(u, v)
        return Aimed(l, self.radiance(l), l, math.inf, density, True)

    def density_of(self, l):
        if self.picture is not None:
            return self.picture.density(l)
        return np.full(len(l), 1.0 / (4.0 * np.pi))


# ---------------------------------------------------------------------------------------------
# Faces that shine
# ---------------------------------------------------------------------------------------------


class Ball:
    def __init__(self, center, radius):
        self.middle, self.radius = center, radius

    def sin2(self, p):
        to = self.middle - p
        return self.radius**2 / dots(to, to)

    def share(self, p):
        """Returns an estimate of the irradiance that light 1 brings; from inside, it is not aimed at."""
        return np.where(self.sin2(p) < 1.0, np.pi * self.sin2(p), 0.0)

    def aim(self, p, u, v):
        """Returns directions, distances and densities."""
        l = cone_sample(units(self.middle - p), np.minimum(1.0, self.sin2(p)), u, v)
        return l, to_ball(self.middle - p, self.radius, l), self.density(p, None, None)

    def density(self, p, at, n):
        sin2 = np.minimum(1.0, self.sin2(p))
        return np.where(self.sin2(p) < 1.0, cone_density(sin2), 0.0)


class Area:
    """What is aimed at by points that are evenly distributed over it."""

    def aim(self, p, u, v):
        at, n = self.at(u, v)
        to = at - p
        return units(to), np.linalg.norm(to, axis=1), self.density(p, at, n)

    def density(self, p, at, n):
        to = at - p
        return dots(to, to) / (self.area * np.abs(dots(units(to), n)))

    def share(self, p):
        to = self.middle - p
        return self.area / np.maximum(dots(to, to), self.area)


class Flat(Area):
    def __init__(self, form, origin, e, f):
        self.form, self.origin, self.e, self.f = form, origin, e, f
        across = np.cross(e, f)
        size = np.linalg.norm(across)
        self.n = across / size
        self.area = size * {"Disc": np.pi, "Rectangle": 1.0, "Triangle": 0.5}[form]
        self.middle = origin + (e + f) * {"Disc": 0.0, "Rectangle": 1.0 / 2.0, "Triangle": 1.0 / 3.0}[form]

    def at(self, u, v):
        if self.form == "Disc":
            x, y = disc(u, v)
        elif self.form == "Rectangle":
            x, y = u, v
        else:
            x, y = 1.0 - np.sqrt(u), v * np.sqrt(u)
        return self.origin + x[:, None] * self.e + y[:, None] * self.f, self.n

    def density(self, p, at, n):
        return super().density(p, at, self.n)

    def share(self, p):
        cos = np.abs(dots(units(self.middle - p), self.n[None]))
        return super().share(p) * (0.1 + 0.9 * np.nan_to_num(cos, nan=1.0))


def around(w, v):
    """Returns the unit vectors at right angles to an axis."""
    cos, sin = circle(v)
    x, y, _ = frame(w)
    return cos[:, None] * x + sin[:, None] * y


class Side(Area):
    """The side of a cylinder or a cone."""

    def __init__(self, a, b, low, high):
        self.a, self.along, self.low, self.high = a, b - a, low, high
        self.tall = np.linalg.norm(b - a)
        self.middle = (a + b) / 2.0
        self.area = np.pi * (low + high) * np.hypot(self.tall, high - low)

    def at(self, u, v):
        w = self.along / self.tall
        radius = np.sqrt(self.low**2 + u * (self.high**2 - self.low**2))
        # The part of the height, without dividing by the difference of the radii.
        height = u * (self.low + self.high) / (self.low + radius)
        out = around(w, v)
        n = units(out - (self.high - self.low) / self.tall * w)
        return self.a + height[:, None] * self.along + radius[:, None] * out, n


class Capsule(Area):
    def __init__(self, a, b, radius):
        self.a, self.b, self.radius = a, b, radius
        self.tall = np.linalg.norm(b - a)
        self.middle = (a + b) / 2.0
        self.area = 2.0 * np.pi * radius * (self.tall + 2.0 * radius)

    def at(self, u, v):
        w = (self.b - self.a) / self.tall
        side = self.tall / (self.tall + 2.0 * self.radius)
        is_side = (u < side)[:, None]
        rest = (u - side) / (1.0 - side)
        on_ball = outward(frame(np.broadcast_to(w, (len(u), 3))), polar(1.0 - 2.0 * rest, v))
        n = np.where(is_side, around(w, v), on_ball)
        ends = np.where(dots(n, w[None])[:, None] > 0.0, self.b, self.a)
        on_axis = np.where(is_side, self.a + (u / side)[:, None] * (self.b - self.a), ends)
        return on_axis + self.radius * n, n


class Lamp:
    """Faces that shine: one, or all of a capsule."""

    def has_place(self):
        return True

    def place(self):
        return self.target.middle

    def power(self):
        target = self.target
        return self.light.max() * (np.pi * target.radius**2 if isinstance(target, Ball) else target.area)

    def __init__(self, world, target, faces, light):
        self.world, self.target, self.faces, self.light = world, target, faces, light

    def weight(self, p):
        return self.light.max() * self.target.share(p)

    def density(self, p, at, n):
        return self.target.density(p, at, n)

    def aim(self, start, u, v):
        l, distance, density = self.target.aim(start.p, u, v)
        way = l * distance[:, None]
        light = np.broadcast_to(self.light, l.shape)
        # A part of a round face may lie behind another, and what lies behind is not aimed at.
        shape = self.world.faces.shape_of[self.faces[0]]
        if not isinstance(self.target, Flat):
            t, face, _ = self.world.faces.ends(shape, start, way)
            first = t.argmin(axis=0)[None]
            nearest = np.take_along_axis(t, first, axis=0)[0]
            face = np.take_along_axis(face, first, axis=0)[0]
            is_it = np.isin(face, self.faces) & (np.abs(nearest - 1.0) <= 2.0**-20)
            light = np.where(is_it[:, None], light, 0.0)
        return Aimed(l, light, way, BEFORE_LIGHT, density, True)


def targets_of(name, fields):
    """Returns the faces of a geometry that can be aimed at: their numbers and the targets."""

    def place(field):
        return np.array(fields[field], float)

    def flat_disc(center, n, radius):
        x, y, _ = frame(n)
        return Flat("Disc", center, radius * x, radius * y)

    if name == "Sphere":
        return [([0], Ball(place("center"), fields["radius"]))]
    if name == "Disc":
        return [([0], flat_disc(place("center"), units(place("normal")), fields["radius"]))]
    if name == "Rectangle":
        return [([0], Flat(name, place("corner"), place("edge_u"), place("edge_v")))]
    if name == "Triangle":
        a, b, c = map(place, "abc")
        return [([0], Flat(name, a, b - a, c - a))]
    if name == "Box":
        low, size = place("min"), place("max") - place("min")
        edges = np.diag(size)
        return [
            ([face], Flat("Rectangle", low + edges[axis] * (face % 2), edges[(axis + 1) % 3], edges[(axis + 2) % 3]))
            for face, axis in enumerate((0, 0, 1, 1, 2, 2))
        ]
    if name in ("Cylinder", "Cone"):
        a, b, low = place("from"), place("to"), fields["radius"]
        high = low if name == "Cylinder" else optional(fields, "top_radius", 0.0)
        targets = [([0], Side(a, b, low, high))]
        if optional(fields, "capped", True):
            caps = [([1], a, low), ([2], b, high)]
            targets += [(face, flat_disc(end, units(b - a), radius)) for face, end, radius in caps if radius > 0.0]
        return targets
    if name == "Capsule":
        return [([0, 1, 2], Capsule(place("from"), place("to"), fields["radius"]))]
    return []


def placed(target, matrix):
    """Returns a target that is mapped by a matrix, None if it cannot be aimed at."""
    linear, shift = np.array([row[:3] for row in matrix]), np.array([row[3] for row in matrix])

    def point(p):
        return linear @ p + shift

    if isinstance(target, Flat):
        return Flat(target.form, point(target.origin), linear @ target.e, linear @ target.f)
    # Round faces stay round only if they are turned, and all lengths are changed alike.
    size = np.linalg.norm(linear[:, 0])
    if np.abs(linear.T @ linear - size * size * np.eye(3)).max() > 1e-9 * size * size:
        return None
    if isinstance(target, Ball):
        return Ball(point(target.middle), size * target.radius)
    if isinstance(target, Capsule):
        return Capsule(point(target.a), point(target.b), size * target.radius)
    return Side(point(target.a), point(target.a + target.along), size * target.low, size * target.high)


def of_geometry(name, fields):
    """Returns the targets of a geometry, and how many faces it has; each triangle of a mesh is one."""
    if name == "Mesh":
        corners = [dict(zip("abc", face)) for face in shapes.faces_of(fields)]
        corners = [each for each in corners if shapes.refusal("Triangle", each) is None]
        found = [([at], targets_of("Triangle", each)[0][1]) for at, each in enumerate(corners)]
    else:
        found = targets_of(name, fields)
    if "placed" in fields:
        found = [(faces, placed(target, fields["placed"])) for faces, target in found]
    return [(faces, target) for faces, target in found if target is not None]


def finite(weights):
    return np.where(np.isfinite(weights), weights, 0.0)


class Tree:
    """Emitters that have a place: two halves of them, or one alone."""

    def __init__(self, all_emitters, numbers):
        self.all, self.numbers, self.parts = all_emitters, numbers, []
        middles = np.array([all_emitters[number].place() for number in numbers])
        low, high = middles.min(axis=0), middles.max(axis=0)
        half = (high - low) / 2.0
        self.middle, self.half2 = low + half, half @ half
        self.power = sum(all_emitters[number].power() for number in numbers)
        if len(numbers) > 1:
            axis = int(half.argmax())
            order = sorted(range(len(numbers)), key=lambda at: (middles[at][axis], numbers[at]))
            order = [numbers[at] for at in order]
            self.parts = [Tree(all_emitters, half) for half in (order[: len(order) // 2], order[len(order) // 2 :])]

    def weight(self, p):
        to = p - self.middle
        return finite(self.power / np.maximum(dots(to, to), self.half2))

    def of_parts(self, p):
        """Returns the weights of both halves; that of an emitter alone is its own."""
        alone = [None if part.parts else self.all[part.numbers[0]] for part in self.parts]
        return [part.weight(p) if one is None else finite(one.weight(p)) for part, one in zip(self.parts, alone)]

    def choice(self, p, u):
        """Returns the emitter that a number chooses at one point and its P; -1 where none shines."""
        if not self.parts:
            return self.numbers[0], 1.0
        first, other = (weight[0] for weight in self.of_parts(p))
        at = u * (first + other)
        if at < first:
            number, part = self.parts[0].choice(p, at / first)
            return number, part * first / (first + other)
        if not other > 0.0:
            return -1, 0.0
        number, part = self.parts[1].choice(p, (at - first) / other)
        return number, part * other / (first + other)

    def probability(self, p, number):
        if not self.parts:
            return np.ones(len(p))
        weights = self.of_parts(p)
        of = 0 if number in self.parts[0].numbers else 1
        part = np.where(weights[of] > 0.0, weights[of] / sum(weights), 0.0)
        return part * self.parts[of].probability(p, number)


class Emitters:
    def __init__(self, world, scene):
        self.all = []
        for light in world.lights:
            if light[0] == "Environment":
                self.all.append(Environment(light[1]))
            elif light[0] in ("Directional", "Point", "Spot"):
                self.all.append(Light(world, light))
        # The emitter of each face.
        self.of_face = np.full(len(world.materials), -1)
        for number, geometry in enumerate(scene["geometries"]):
            first = int(np.argmax(world.owners == number))
            for faces, target in of_geometry(*variant(geometry)):
                faces = [first + face for face in faces]
                material = world.materials[faces[0]]
                light = material.intensity * material.color
                if material.kind == "Emissive" and light.max() > 0.0:
                    self.of_face[faces] = len(self.all)
                    self.all.append(Lamp(world, target, faces, light))
        placed = [number for number, each in enumerate(self.all) if each.has_place()]
        self.tree = Tree(self.all, placed) if len(placed) > FEW else None
        self.listed = [number for number in range(len(self.all)) if self.tree is None or number not in placed]
        self.environment = next((each for each in self.all if isinstance(each, Environment)), None)

    def weights(self, p):
        """Returns W, a column for each emitter that is listed, and one for the tree."""
        weights = [finite(self.all[number].weight(p)) for number in self.listed]
        weights += [] if self.tree is None else [self.tree.weight(p)]
        return np.array(weights).reshape(-1, len(p)).T

    def probability(self, p, number):
        """Returns P of one emitter at each point."""
        weights = self.weights(p)
        found = np.zeros(len(p))
        for each in np.unique(number):
            rows = number == each
            place = self.listed.index(each) if each in self.listed else len(self.listed)
            part = np.nan_to_num(weights[rows, place] / weights[rows].sum(axis=1))
            found[rows] = part if each in self.listed else part * self.tree.probability(p[rows], each)
        return found

    def choice(self, p, u):
        """Returns the emitters that numbers choose and their P; -1 where none shines."""
        if not self.all:
            return np.full(len(p), -1), np.zeros(len(p))
        weights = self.weights(p)
        sums = np.cumsum(weights, axis=1)
        at = u * sums[:, -1]
        place = (sums <= at[:, None]).sum(axis=1)
        is_any = (sums[:, -1] > 0.0) & (place < weights.shape[1])
        place = np.where(is_any, place, 0)
        rows = np.arange(len(p))
        own = weights[rows, place]
        part = np.where(is_any, own / sums[:, -1], 0.0)
        number = np.where(is_any, np.array(self.listed + [-1])[place], -1)
        in_tree = np.flatnonzero(is_any & (place == len(self.listed)))
        rest = (at - (sums[rows, place] - own)) / own
        for row in in_tree:
            number[row], of_tree = self.tree.choice(p[row : row + 1], rest[row])
            part[row] *= of_tree
        return number, part
