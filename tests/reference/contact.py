"""Contact: the faces that a point lies on, and what a ray crosses there.

A point where a ray has arrived lies on every face that is nearer than the rounding of its own numbers. A ray
that leaves it leaves them all, and starts on the side from which the point was seen. What it crosses at its
start is listed as a sense for each face: 1 where it enters through it, -1 where it leaves, 0 where it does
not cross. Of a solid, one face stands for all.
"""

import math

import numpy as np

from surfaces import EPSILON, dots, positive, units

NONE = np.iinfo(int).max


class Start:
    """Where rays start: points, the faces that they lie on, and the face that was hit.

    A point may be off by r. Its side is that of a point just before it along v, or just behind it.
    """

    def __init__(self, p, own, contact, r, v, is_behind):
        self.p, self.own, self.contact, self.r, self.v, self.is_behind = p, own, contact, r, v, is_behind

    def __getitem__(self, rows):
        return Start(*(value[rows] for value in vars(self).values()))

    def __len__(self):
        return len(self.p)

    def of(self, own):
        """Returns these points as those of other faces that lie there."""
        return Start(self.p, own, self.contact, self.r, self.v, self.is_behind)

    def replaced(self, rows, others):
        """Returns the same with others in some rows."""
        made = {name: value.copy() for name, value in vars(self).items()}
        for name, value in vars(others).items():
            made[name][rows] = value
        return Start(**made)

    def sided(self, d, stays):
        """Returns what starts on this side, or behind the faces that a ray along d crosses."""
        v = np.where(stays[:, None], self.v, d)
        return Start(self.p, self.own, self.contact, self.r, v, self.is_behind | ~stays)

    def through(self, d):
        """Returns what starts behind the faces that a ray along d crosses."""
        return Start(self.p, self.own, self.contact, self.r, d, np.ones(len(self), bool))


def listed(sense):
    """Returns the faces that each ray crosses, in their order, and the senses: a row for each."""
    count = max(1, (sense != 0).sum(axis=1).max(initial=0))
    faces = np.argsort(sense == 0, axis=1, kind="stable")[:, :count]
    return faces.T, np.take_along_axis(sense, faces, axis=1).T


def fresnel(cos_i, ratio):
    """Returns the unpolarized Fresnel factor and the cosine inside; ratio is n outside / n inside."""
    sin2 = ratio**2 * (1.0 - cos_i**2)
    cos_t = np.sqrt(np.maximum(0.0, 1.0 - sin2))
    rs = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t)
    rp = (cos_i - ratio * cos_t) / (cos_i + ratio * cos_t)
    return np.where(sin2 >= 1.0, 1.0, (rs**2 + rp**2) / 2.0), cos_t


class Faces:
    """All faces of a scene, in their order.

    Of faces at distances that are equal but for rounding, the nearest is hit, or with a small `bias` the last,
    or with a negative one the first.
    """

    def __init__(self, shapes, materials, bodies, bias):
        self.shapes, self.bias = shapes, bias
        self.faces = [face for shape in shapes for face in shape.faces]
        self.first = np.cumsum([0] + [len(shape.faces) for shape in shapes])
        self.shape_of = np.repeat(np.arange(len(shapes)), np.diff(self.first))
        # What is entered and left as one: a solid, all triangles of a mesh.
        self.body_of = np.array(bodies, int)[self.shape_of]
        is_pane = np.array([shape.is_pane for shape in shapes], bool)[self.shape_of]
        self.is_glass = np.array([material.kind == "Glass" for material in materials], bool)
        # Glass that stops light on its straight way, and that which stops it where there is a surface.
        self.stops = np.zeros(len(materials), bool)
        self.is_rough = np.zeros(len(materials), bool)
        self.bends = self.is_glass & ~is_pane
        self.ior = np.array([material.ior for material in materials])
        self.color = np.array([material.color for material in materials]).reshape(-1, 3)

    def normals(self, found, p, d):
        """Returns the unit normals at points of some faces."""
        return self.gather(found, p, lambda face, rows: face.normal(p[rows], d[rows]))

    def gather(self, found, p, value):
        values = np.zeros_like(p)
        for index in np.unique(found[found >= 0]):
            rows = found == index
            values[rows] = value(self.faces[index], rows)
        return values

    # -----------------------------------------------------------------------------------------
    # Hits
    # -----------------------------------------------------------------------------------------

    def nowhere(self, o):
        """Returns the starts of rays that leave no face."""
        contact = np.zeros((len(o), len(self.faces)), bool)
        return Start(o, np.full(len(o), -1), contact, np.zeros(len(o)), o, np.zeros(len(o), bool))

    def ends(self, index, start, d):
        """Returns the t at which rays meet a shape, infinity for none, the faces, and the senses."""
        shape, first = self.shapes[index], self.first[index]
        t, number = shape.ends(start.p, d, start.contact[:, first : self.first[index + 1]].T)
        if shape.is_thin:
            n = shape.faces[0].gradient
            at = [start.p + np.where(np.isfinite(each), each, 0.0)[:, None] * d for each in t]
            sense = np.array([np.where(dots(d, n(p)) > 0.0, -1, 1) for p in at])
        else:
            sense = np.where(np.arange(len(t)) % 2, -1, 1)[:, None] * np.ones(t.shape, int)
        return positive(t), first + number, sense

    def hit(self, start, d):
        """Returns the face and the t of the nearest hits; face -1 where nothing is hit."""
        nearest = np.full(len(d), math.inf)
        found = np.full(len(d), -1)
        for index in range(len(self.shapes)):
            for t, face, _ in zip(*self.ends(index, start, d)):
                nearer = t < nearest * (1.0 + self.bias)
                nearest[nearer], found[nearer] = t[nearer], face[nearer]
        return found, nearest

    def at(self, o, d, t, own):
        """Returns the points where rays arrive at faces, as starts of others."""
        along = t[:, None] * d
        p = o + along
        size = (np.abs(o) + np.abs(along)).max(axis=1)
        away = self.gather(own, p, lambda face, rows: face.distance(p[rows])[:, None])[:, 0]
        r = EPSILON * size + np.minimum(2.0 * away, 2.0**-24 * size)
        contact = np.array([face.touches(p, r, o) for face in self.faces]).T.reshape(len(p), -1)
        contact[np.arange(len(p)), own] = True
        return Start(p, own, contact, r, d, np.zeros(len(p), bool))

    # -----------------------------------------------------------------------------------------
    # Crossings at P
    # -----------------------------------------------------------------------------------------

    def crossed(self, start, l, arrives=False):
        """Returns in which sense rays along l cross each face in contact; all thin ones where they arrive.

        A ray that starts on its own face alone crosses nothing there.
        """
        sense = np.zeros(start.contact.shape, int)
        several = start.contact.sum(axis=1) > 1
        for index, shape in enumerate(self.shapes):
            columns = slice(self.first[index], self.first[index + 1])
            rows = np.flatnonzero(several & start.contact[:, columns].any(axis=1))
            if len(rows):
                crossing = self.skin if shape.is_thin else self.change
                sense[rows, columns] = crossing(index, start[rows], l[rows], arrives)
        return sense

    def skin(self, index, start, l, arrives):
        """Returns the senses for the face of a thin shape."""
        face = self.faces[self.first[index]]
        n = face.gradient(start.p)
        sense = np.where(dots(l, n) > 0.0, -1, 1)
        if arrives:
            return sense[:, None]
        side = np.where(start.is_behind[:, None], -start.v, start.v)
        before, behind = dots(side, n), dots(l, n)
        crosses = before * behind > 0.0
        own = self.gather(start.own, start.p, lambda each, rows: each.gradient(start.p[rows]))
        lengths = np.linalg.norm(n, axis=1) * np.linalg.norm(own, axis=1)
        crosses &= np.linalg.norm(np.cross(n, own), axis=1) > 2.0**-20 * lengths
        # Where the plane of both rays cuts the face, it must not have ended.
        along = np.abs(before)[:, None] * l - np.abs(behind)[:, None] * side
        for distance, inward in face.edges(face.local(start.p)):
            is_far = distance > face.slack(start.p, start.r)
            crosses &= is_far | (dots(inward, along @ face.back.T) > 0.0)
        return np.where(crosses, sense, 0)[:, None]

    def change(self, index, start, l, arrives):
        """Returns the senses for the faces of a solid: one of them stands for its change."""
        shape, first, last = self.shapes[index], self.first[index], self.first[index + 1]
        touched = start.contact[:, first:last]
        before = shape.is_inside(start.p, start.v, touched.T, start.is_behind)
        behind = shape.is_inside(start.p, l, touched.T, True)
        change = behind.astype(int) - before
        facing = np.array([dots(l, face.gradient(start.p)) for face in shape.faces]).T
        suits = touched & (facing * change[:, None] < 0.0)
        suits = np.where(suits.any(axis=1)[:, None], suits, touched)
        number = suits.argmax(axis=1)
        own = start.own - first
        number = np.where(arrives & (0 <= own) & (own < last - first), own, number)
        return np.where(np.arange(last - first) == number[:, None], change[:, None], 0)

    def met(self, face, sense):
        """Returns what counts among crossings at one place: a row of faces and senses for each.

        These are the first opaque face, the first glass that is left, the first that is entered, the
        first of both, and the first pane; NONE where there is none.
        """
        for body in np.unique(self.body_of[face[(sense != 0) & self.bends[face]]]):
            of_body = (self.body_of[face] == body) & self.bends[face]
            both = (of_body & (sense > 0)).any(axis=0) & (of_body & (sense < 0)).any(axis=0)
            sense = np.where(of_body & both, 0, sense)

        def first(counts):
            return np.where(counts, face, NONE).min(axis=0)

        bends, glass = self.bends[face], self.is_glass[face]
        left, entered = first(bends & (sense < 0)), first(bends & (sense > 0))
        opaque, pane = first(~glass & (sense != 0)), first(glass & ~bends & (sense != 0))
        return opaque, left, entered, np.minimum(left, entered), pane

    def indices(self, face):
        """Returns the refractive indices of glass, 1 for none."""
        return np.where(face == NONE, 1.0, self.ior[np.where(face == NONE, 0, face)])

    def tint(self, face):
        """Returns the colors of glass, white for none."""
        return np.where((face == NONE)[:, None], 1.0, self.color[np.where(face == NONE, 0, face)])

    # -----------------------------------------------------------------------------------------
    # Shadows
    # -----------------------------------------------------------------------------------------

    def transmission(self, start, d, limit):
        """Returns the part of the light that arrives at P from P + d, for each channel."""
        part = np.ones((len(d), 3))
        face, sense = listed(self.crossed(start, d))
        events = [(np.where(sense == 0, math.inf, 0.0), face, sense)]
        dark = ((sense != 0) & ~self.is_glass[face]).any(axis=0)
        for index in range(len(self.shapes)):
            rows = np.flatnonzero(~dark)
            t, face, sense = self.ends(index, start[rows], d[rows])
            t = np.where(t < limit, t, math.inf)
            dark[rows] = (np.isfinite(t) & ~self.is_glass[face]).any(axis=0)
            if self.is_glass[face].any():
                whole = np.full((3, len(t), len(d)), math.inf)
                whole[1:] = 0
                whole[:, :, rows] = t, face, sense
                events.append((whole[0], whole[1].astype(int), whole[2].astype(int)))
        part[dark] = 0.0
        t, face, sense = (np.concatenate(values) for values in zip(*events))
        rows = np.flatnonzero(~dark & np.isfinite(t).any(axis=0))
        if len(rows):
            part[rows] = self.through(start.p[rows], d[rows], t[:, rows], face[:, rows], sense[:, rows])
        return part

    def through(self, p, d, t, face, sense):
        """Returns the part of light that passes crossings of glass."""
        order = np.argsort(t, axis=0, kind="stable")[: np.isfinite(t).sum(axis=0).max()]
        t, face, sense = (np.take_along_axis(values, order, axis=0) for values in (t, face, sense))
        sense[~np.isfinite(t)] = 0
        at = p + np.where(sense != 0, t, 0.0)[:, :, None] * d
        cos = np.array([np.abs(dots(units(d), self.normals(f, x, d))) for f, x in zip(face, at)])
        # Crossings that are as near as rounding are one.
        gaps = np.diff(t, axis=0) * np.linalg.norm(d, axis=1) * np.minimum(cos[1:], cos[:-1])
        size = (np.abs(p) + np.abs(t[1:, :, None] * d)).max(axis=-1)
        places = np.zeros(t.shape, int)
        places[1:] = np.cumsum(~(gaps <= 4.0 * EPSILON * size), axis=0)
        part = np.ones_like(p)
        for place in range(places.max() + 1):
            here = np.where(places == place, sense, 0)
            _, left, entered, changed, pane = self.met(face, here)
            one, other = self.indices(left), self.indices(entered)
            is_joint = np.maximum(left, entered) != NONE
            ratio = np.where(is_joint, np.minimum(one, other) / np.maximum(one, other), 1.0 / (one * other))
            seen = np.where(changed == NONE, pane, changed)
            is_pane = (changed == NONE) & (pane != NONE)
            ratio = np.where(is_pane, 1.0 / self.indices(pane), ratio)
            cos_i = np.where((face == seen) & (here != 0), cos, 0.0).max(axis=0)
            f = np.where(ratio == 1.0, 0.0, fresnel(cos_i, ratio)[0])
            tint = self.tint(left) * self.tint(entered) * self.tint(np.where(is_pane, pane, NONE))
            part *= np.where((seen == NONE)[:, None], 1.0, (1.0 - f)[:, None] * tint)
            for counts in (left, entered, np.where(is_pane, pane, NONE)):
                glass = np.where(counts == NONE, 0, counts)
                stops = self.stops[glass] | self.is_rough[glass] & (ratio != 1.0)
                part[stops & (counts != NONE)] = 0.0
        return part
