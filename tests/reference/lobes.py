"""The lobes of materials under light by paths: what they scatter, and the directions that they choose.

All vectors are in a frame whose third axis is the normal on the side of the viewer, v.
"""

import functools

import numpy as np

from contact import fresnel
from pairs import circle, disc
from surfaces import dots, units

NODES = MIDPOINTS = 64


def mirrored(v, h):
    return 2.0 * dots(v, h)[:, None] * h - v


def schlick(cos):
    return (1.0 - cos) ** 5


# ---------------------------------------------------------------------------------------------
# Microfacets
# ---------------------------------------------------------------------------------------------


class Facets:
    """Normals h by GGX, of which an α determines all. α = 0 is a mirror."""

    def __init__(self, alpha):
        self.alpha = alpha

    def d(self, h):
        squared = self.alpha**2
        return squared / (np.pi * (h[:, 2] ** 2 * (squared - 1.0) + 1.0) ** 2)

    def s(self, z):
        return np.sqrt(z * z + self.alpha**2 * (1.0 - z * z))

    def g1(self, z):
        return 2.0 * z / (z + self.s(z))

    def g2(self, v, l):
        return 2.0 * v * l / (v * self.s(l) + l * self.s(v))

    def sample(self, v, u, t):
        by = np.array([self.alpha, self.alpha, 1.0])
        w = units(v * by)
        z = (1.0 - u) * (1.0 + w[:, 2]) - w[:, 2]
        radius = np.sqrt(np.maximum(0.0, 1.0 - z * z))
        cos, sin = circle(t)
        return units((np.stack([radius * cos, radius * sin, z], axis=-1) + w) * by)

    def density(self, v, h):
        return self.g1(v[:, 2]) * np.maximum(0.0, dots(v, h)) * self.d(h) / v[:, 2]

    def parts(self, cos):
        """Returns a and b: the parts of 1 - f and f that are reflected."""
        if self.alpha == 0.0:
            return 1.0 - schlick(cos), schlick(cos)
        a, b = reflected_parts(self.alpha)
        return between(a, cos), between(b, cos)

    def means(self):
        if self.alpha == 0.0:
            return 20.0 / 21.0, 1.0 / 21.0
        return tuple(map(mean, reflected_parts(self.alpha)))


def alpha_of(roughness):
    return max(roughness * roughness, 1e-4) if roughness > 0.0 else 0.0


def nodes():
    places = (np.arange(NODES) / (NODES - 1.0)) ** 2
    places[0] = 1e-4
    return places


def between(values, cos):
    """Returns the values of the lines between nodes."""
    return np.interp(cos, nodes(), values)


def mean(values):
    """Returns 2∫ value · μ dμ, as Simpson's rule has it, which is exact for lines."""
    x = nodes()
    middle = (x[1:] + x[:-1]) / 2.0 * (values[1:] + values[:-1]) / 2.0
    ends = x * values
    whole = np.sum((x[1:] - x[:-1]) * (ends[1:] + 4.0 * middle + ends[:-1]) / 6.0)
    # Before the first node, the value is that of the first node.
    return 2.0 * (whole + values[0] * x[0] ** 2 / 2.0)


def quadratures(of):
    """Returns the mean of a function of v, u and t for each node."""
    places = (np.arange(MIDPOINTS) + 0.5) / MIDPOINTS
    t, turn = (each.ravel() for each in np.meshgrid(places, places, indexing="ij"))
    for cos in nodes():
        v = np.broadcast_to([np.sqrt(1.0 - cos * cos), 0.0, cos], (len(t), 3))
        yield [np.mean(2.0 * t * values) for values in of(v, 1.0 - t * t, turn)]


@functools.lru_cache(maxsize=None)
def reflected_parts(alpha):
    facets = Facets(alpha)

    def of(v, u, t):
        h = facets.sample(v, u, t)
        l = mirrored(v, h)
        seen = np.where(l[:, 2] > 0.0, facets.g2(v[:, 2], l[:, 2]) / facets.g1(v[:, 2]), 0.0)
        f = schlick(dots(v, h))
        return seen * (1.0 - f), seen * f

    a, b = zip(*quadratures(of))
    return np.array(a), np.array(b)


@functools.lru_cache(maxsize=None)
def sent_parts(alpha, eta):
    """Returns E of rough glass at the nodes: what it reflects and refracts."""
    facets = Facets(alpha)

    def of(v, u, t):
        h = facets.sample(v, u, t)
        f, cos_t = fresnel(dots(v, h), 1.0 / eta)

        def seen(z):
            return np.where(z > 0.0, facets.g2(v[:, 2], z) / facets.g1(v[:, 2]), 0.0)

        return [f * seen(mirrored(v, h)[:, 2]) + (1.0 - f) * seen(-bent(v, h, eta, cos_t)[:, 2])]

    return np.array([values[0] for values in quadratures(of)])


def bent(v, h, eta, cos_t):
    return -v / eta + (dots(v, h) / eta - cos_t)[:, None] * h


# ---------------------------------------------------------------------------------------------
# Lobes
# ---------------------------------------------------------------------------------------------


def above(v):
    """Returns directions to the viewer that are not below the surface."""
    return np.concatenate([v[:, :2], np.maximum(v[:, 2:], 1e-12)], axis=1)


class Scattered:
    """The light that comes from a direction: of the diffuse lobe and of all, and the density of the direction."""

    def __init__(self, diffuse, everything, density):
        self.diffuse, self.all, self.density = diffuse, everything, density

    def kept(self, rows):
        """Returns the same in some rows, and nothing in others."""
        values = vars(self).values()
        return Scattered(*(np.where(rows.reshape(-1, *[1] * (each.ndim - 1)), each, 0.0) for each in values))

    def share(self):
        """Returns the part that the diffuse lobe has."""
        return np.where(self.all > 0.0, self.diffuse / self.all, 0.0)


class Opaque:
    """A diffuse lobe, one of microfacets and a mirror, of which each may be black."""

    def __init__(self, material, v):
        self.v = above(v)
        z = self.v[:, 2]
        black = np.zeros(3)
        self.facets, self.mirror, self.albedo, gloss = None, black, black, black
        # The part of light that gets to the diffuse lobe, and the factor by which that scatters it again.
        self.passes, self.again = np.ones_like, 1.0
        if material.kind == "Mirror":
            self.mirror = material.color
        elif material.kind == "Matte":
            self.albedo = material.color
        elif material.kind == "Phong":
            squared = 2.0 / (4.0 * material.exponent + 2.0)
            f0 = np.minimum(1.0, 4.0 * squared * material.specular)
            whole = material.color + f0 + material.reflection
            by = np.maximum(1.0, whole.max(axis=-1, keepdims=True))
            self.albedo, self.mirror, f0 = material.color / by, material.reflection / by, f0 / by
            self.facets = Facets(np.sqrt(squared))
            self.f = lambda cos: f0
            gloss = f0 * sum(self.facets.parts(z))[:, None]
        else:
            gloss = self.layers(material, z)
        of_diffuse = self.albedo * self.passes(z)[:, None]
        parts = [np.broadcast_to(part, v.shape).mean(axis=1) for part in (self.mirror, gloss, of_diffuse)]
        whole = np.where(sum(parts) > 0.0, sum(parts), 1.0)
        self.of_mirror, self.of_gloss, self.of_diffuse = (part / whole for part in parts)

    def layers(self, material, z):
        """Sets the lobes of metal and of a coat above a diffuse surface; returns the part of the specular one."""
        facets, m = Facets(alpha_of(material.roughness)), material.metallic
        f_d = ((material.ior - 1.0) / (material.ior + 1.0)) ** 2

        def comp(f0, e):
            return 1.0 + f0 * (1.0 - e) / e

        def reflected(f0, a, b):
            return (f0 * a + b) * comp(f0, a + b)

        a, b = (each[:, None] for each in facets.parts(z))
        layers = [(1.0 - m, f_d), (m, material.color)]

        def f(cos):
            return sum(part * (f0 + (1.0 - f0) * schlick(cos)[:, None]) * comp(f0, a + b) for part, f0 in layers)

        self.passes = lambda cos: 1.0 - reflected(f_d, *facets.parts(cos))
        self.albedo = (1.0 - m) * material.color
        self.again = 1.0 / (1.0 - reflected(f_d, *facets.means()))
        if facets.alpha == 0.0:
            self.mirror = f(z)
            return np.zeros(3)
        self.facets, self.f = facets, f
        return sum(part * reflected(f0, a, b) for part, f0 in layers)

    def is_mirror(self):
        return self.facets is None and not np.any(self.albedo)

    def scattered(self, l):
        """Returns the light that comes from directions."""
        z = np.maximum(l[:, 2], 1e-300)
        by = self.passes(self.v[:, 2]) * self.passes(z) * self.again * z / np.pi
        diffuse = self.albedo * by[:, None]
        everything, density = diffuse, self.of_diffuse * z / np.pi
        if self.facets is not None:
            h = units(self.v + l)
            cos = dots(self.v, h)
            mirrors = self.facets.d(h) * self.facets.g2(self.v[:, 2], z) / (4.0 * self.v[:, 2])
            everything = diffuse + mirrors[:, None] * self.f(cos)
            density = density + self.of_gloss * self.facets.density(self.v, h) / (4.0 * cos)
        return Scattered(diffuse, everything, density).kept(l[:, 2] > 0.0)

    def sample(self, u, pair):
        """Returns directions, which of the lobes chose them, and which paths are mirrored instead, with a factor."""
        is_mirror = u < self.of_mirror
        is_gloss = ~is_mirror & (u < self.of_mirror + self.of_gloss)
        x, y = disc(*pair)
        l = np.stack([x, y, np.sqrt(1.0 - pair[0])], axis=-1)
        if self.facets is not None:
            l[is_gloss] = mirrored(self.v, self.facets.sample(self.v, *pair))[is_gloss]
        factor = self.mirror / np.where(is_mirror, self.of_mirror, 1.0)[:, None]
        return l, ~is_mirror & ~is_gloss, is_mirror, factor


class RoughGlass:
    """A rough surface of glass, seen from the side of v. eta is the index behind it relative to that before it."""

    def __init__(self, alpha, eta, is_pane, tint, v):
        self.facets, self.eta, self.is_pane, self.tint, self.v = Facets(alpha), eta, is_pane, tint, above(v)
        z = self.v[:, 2]
        self.e = sum(self.facets.parts(z)) if is_pane else between(sent_parts(alpha, eta), z)

    def scattered(self, l):
        is_up = l[:, 2] > 0.0
        # Through a pane, light goes as it is reflected, but to the other side.
        turned = l * np.where(is_up, 1.0, -1.0)[:, None] ** [0, 0, 1] if self.is_pane else l
        as_mirror = turned[:, 2] > 0.0
        h = units(np.where(as_mirror[:, None], self.v + turned, self.v + self.eta * l))
        h = h * np.where(h[:, 2] < 0.0, -1.0, 1.0)[:, None]
        to_v, to_l = dots(self.v, h), dots(turned, h)
        f = fresnel(to_v, 1.0 / self.eta)[0]
        stretch = np.where(as_mirror, 1.0 / (4.0 * to_v), self.eta**2 * np.abs(to_l) / (to_v + self.eta * to_l) ** 2)
        density = self.facets.density(self.v, h) * np.where(is_up, f, 1.0 - f) * stretch
        z = self.v[:, 2]
        weight = self.facets.g2(z, np.abs(l[:, 2])) / self.facets.g1(z) / self.e
        everything = np.where(is_up[:, None], 1.0, self.tint) * (density * weight)[:, None]
        is_possible = (to_v > 0.0) & ((to_l > 0.0) == as_mirror) & (l[:, 2] != 0.0)
        return Scattered(np.zeros_like(l), everything, density).kept(is_possible)

    def sample(self, u, pair):
        """Returns directions, and which of them are on the right side of the surface."""
        h = self.facets.sample(self.v, *pair)
        f, cos_t = fresnel(dots(self.v, h), 1.0 / self.eta)
        is_up = u < f
        up = mirrored(self.v, h)
        down = up * [1.0, 1.0, -1.0] if self.is_pane else bent(self.v, h, self.eta, cos_t)
        l = np.where(is_up[:, None], up, down)
        return l, (l[:, 2] > 0.0) == is_up
