#!/usr/bin/env python3
"""Evaluates light by paths, `lighting: Path(...)`, and compares the result with a picture's layers.

    paths.py scene.json --layers a.npz    the layers direct, specular, albedo and coverage of the program

Every number of a path is given by its pixel, its sample and the seed, so this finds the same paths: those of all
samples of all pixels at once, with numpy. Only the order of sums and the last bits of functions differ.
"""

import argparse
import copy
import os
import sys

import numpy as np

import evaluate
import light
import pairs
import textures
from contact import fresnel
from emitters import Emitters, Environment
from evaluate import optional, variant
from lobes import Opaque, RoughGlass, alpha_of
from pairs import Pairs, frame, inward, outward
from surfaces import dots, units

# The vertex from which paths may end by roulette, and the largest probability to go on.
ROULETTE, MOST = 3, 0.95
# The layers that are compared, all in f64.
LAYERS = ("direct", "specular", "albedo", "coverage")
# The part of a pixel's light by which it may differ; of the other layers, the part of 1.
TOLERANCE = 1e-9
# The share of pixels that may differ more: where the last bit of a number decides about a path.
TOLERATED = 0.0002


class Rays:
    """Paths as far as they are known: a row for each, as in arrays of the attributes.

    start, d    the next ray
    origin      where rays are aimed from: the last vertex that scattered, or the last mirror or glass
    beta, q     the factor of the light, and the density of the direction: infinite after a mirror or smooth glass
    share       the part of the light along the ray that a diffuse lobe scatters
    direct      the part of the light that belongs to the layer `direct`
    depth, diffuse_depth    the number of scatterings, and that of those by diffuse lobes
    has_scattered           whether a lobe other than a mirror or smooth glass has scattered the path
    is_caustic              whether it has met a mirror or solid glass since
    number      the path
    """

    def __init__(self, **values):
        vars(self).update(values)

    def __len__(self):
        return len(self.number)

    def __getitem__(self, rows):
        return Rays(**{name: value[rows] for name, value in vars(self).items()})

    def replaced(self, **values):
        return Rays(**(vars(self) | values))


def joined(parts):
    """Returns the rows of several."""
    if isinstance(parts[0], np.ndarray):
        return np.concatenate(parts)
    names = vars(parts[0])
    return type(parts[0])(**{name: joined([getattr(part, name) for part in parts]) for name in names})


class World(light.World):
    def __init__(self, scene, bias=0.0):
        super().__init__(scene, bias)
        fields = variant(scene["lighting"])[1]
        self.samples = int(optional(fields, "samples", 64))
        self.max_depth = int(optional(fields, "max_depth", 32))
        self.diffuse_depth = float(optional(fields, "diffuse_depth", np.inf))
        self.caustics = optional(fields, "caustics", True)
        self.clamp = float(optional(fields, "clamp", np.inf))
        self.seed = int(optional(fields, "seed", 0))
        self.filter = optional(fields, "filter", {"Box": {}})
        self.emitters = Emitters(self, scene)
        glow = {"Ambient": np.zeros(3), "Headlight": np.zeros(3)}
        for name, fields in self.lights:
            if name in glow:
                intensity = float(optional(fields, "intensity", 0.2 if name == "Ambient" else 1.0))
                glow[name] = glow[name] + intensity * light.lin(optional(fields, "color", "#ffffff"))
        self.ambient, self.headlight = glow["Ambient"], glow["Headlight"]
        # Rough glass stops light that is aimed, and so does solid glass where caustics are paths.
        self.alphas = np.array([alpha_of(material.roughness) for material in self.materials])
        # The first face of the same material, for each face.
        whole = [vars(each) | {"texture": id(each.texture)} for each in self.materials]
        same = [[np.asarray(value).tolist() for value in each.values()] for each in whole]
        self.kinds = np.array([same.index(each) for each in same], int)
        self.geometries = [variant(geometry) for geometry in scene["geometries"]]
        self.backdrop = backdrop_of(scene.get("backdrop"))
        faces = self.faces
        faces.stops, faces.is_rough = faces.bends & self.caustics, faces.is_glass & (self.alphas > 0.0)

    # -----------------------------------------------------------------------------------------
    # Light
    # -----------------------------------------------------------------------------------------

    def add(self, rays, value, direct=None):
        """Adds light: that of the first vertex, or of all others."""
        direct = rays.direct if direct is None else direct
        later = (rays.depth > 0).astype(int)
        self.light[rays.number, later, 0] += rays.beta * value * direct
        self.light[rays.number, later, 1] += rays.beta * value * (1.0 - direct)

    def weight(self, rays, number, density):
        """Returns the weight of light that is found, of an emitter with this density of directions."""
        weight = np.ones(len(rays))
        rows = np.flatnonzero(np.isfinite(rays.q) & (number >= 0))
        if len(rows):
            p = self.emitters.probability(rays.origin[rows], number[rows]) * density[rows]
            weight[rows] = rays.q[rows] ** 2 / (rays.q[rows] ** 2 + p**2)
        return weight[:, None]

    def sees_emitters(self, rays):
        return self.caustics | ~rays.is_caustic

    def passed(self, rays, t):
        """Adds the light of the lights of a size that rays pass before they hit something."""
        distance = t * np.linalg.norm(rays.d, axis=1)
        for number, emitter in enumerate(self.emitters.all):
            if not getattr(emitter, "has_size", False) or not emitter.shadows:
                continue
            passes = emitter.is_passed(rays.start.p, rays.d, distance)
            passing = rays[passes & (rays.depth > 0) & self.sees_emitters(rays)]
            if len(passing):
                density = emitter.density(passing.origin)
                weight = self.weight(passing, np.full(len(passing), number), density)
                self.add(passing, weight * emitter.radiance(passing.origin))

    def escaped(self, rays):
        """Adds the light of rays that hit nothing."""
        self.add(rays, rays.share * self.ambient)
        environment = self.emitters.environment
        if environment is not None:
            shows = (rays.depth > 0) | environment.is_visible
            found = rays[shows & self.sees_emitters(rays)]
            number = np.full(len(found), self.emitters.all.index(environment))
            weight = self.weight(found, number, environment.density_of(units(found.d)))
            self.add(found, weight * environment.radiance(units(found.d)))
            rays = rays[~shows]
        behind = self.background if self.backdrop is None else self.backdrop.radiance(units(rays.d))
        self.add(rays, (1.0 - rays.share) * behind)

    def first(self, start):
        colors = super().first(start)
        for own in np.unique(start.own):
            texture = self.materials[own].texture
            if texture is not None:
                rows, face = start.own == own, self.faces.faces[own]
                number = own - self.faces.first[self.faces.shape_of[own]]
                shape = self.geometries[self.owners[own]]
                colors[rows] *= textures.light(texture, shape, number, face.local(start.p[rows]))
        return colors

    def named(self, rays, colors):
        """Notes the color of the first surface that is not a mirror or smooth glass."""
        rows = ~self.has_albedo[rays.number]
        self.albedo[rays.number[rows]] = colors[rows]
        self.has_albedo[rays.number] = True

    def shone(self, rays, is_lamp):
        """Adds the light of surfaces that shine."""
        self.named(rays, self.first(rays.start))
        if is_lamp:
            rays = rays[self.sees_emitters(rays)]
        own = rays.start.own
        number = np.where(is_lamp, self.emitters.of_face[own], -1)
        density = np.zeros(len(rays))
        _, n = self.facing(rays.start, rays.d)
        for each in np.unique(number[number >= 0]):
            rows = number == each
            density[rows] = self.emitters.all[each].density(rays.origin[rows], rays.start.p[rows], n[rows])
        intensity = self.gather("intensity", own) if is_lamp else np.ones(len(rays))
        self.add(rays, self.weight(rays, number, density) * self.first(rays.start) * intensity[:, None])

    def is_exhausted(self, rays):
        return (rays.depth >= self.max_depth) | (rays.diffuse_depth > self.diffuse_depth)

    # -----------------------------------------------------------------------------------------
    # Surfaces that scatter
    # -----------------------------------------------------------------------------------------

    def scattered(self, rays, lobes, axes, l):
        """Returns the light from directions; l must be on the same side of both normals."""
        _, n = self.facing(rays.start, rays.d)
        flat = self.faces.gather(rays.start.own, rays.start.p, lambda face, rows: face.gradient(rays.start.p[rows]))
        same = (dots(n, l) > 0.0) == (dots(n, -rays.d) > 0.0)
        flat_same = (dots(flat, l) > 0.0) == (dots(flat, -rays.d) > 0.0)
        return lobes.scattered(inward(axes, l)).kept(same == flat_same)

    def leaving(self, rays, n, l):
        """Returns the starts of rays from surfaces, on this side or on the other."""
        return rays.start.sided(rays.d, dots(n, l) > 0.0)

    def lit(self, rays, lobes, axes):
        """Adds the light of an emitter that each vertex aims at, and of the headlights at the first one."""
        first = ~rays.has_scattered
        v = -units(rays.d)
        if np.any(self.headlight) and first.any():
            found = self.scattered(rays, lobes, axes, v)
            value = np.where(first[:, None], found.all * np.pi * self.headlight, 0.0)
            self.add(rays, value, np.where((rays.depth == 0)[:, None], found.share(), rays.direct))
        u, _ = self.pairs.at(rays.depth, pairs.CHOICE, rays.number)
        pair = self.pairs.at(rays.depth, pairs.EMITTER, rays.number)
        number, probability = self.emitters.choice(rays.start.p, u)
        value, share = np.zeros_like(rays.beta), np.zeros_like(rays.beta)
        l = np.zeros_like(rays.beta)
        aims = {}
        for each in np.unique(number[number >= 0]):
            rows = np.flatnonzero(number == each)
            aims[each] = rows, self.emitters.all[each].aim(rays.start[rows], pair[0][rows], pair[1][rows])
            l[rows] = aims[each][1].l
        found = self.scattered(rays, lobes, axes, l)
        for rows, aim in aims.values():
            p = probability[rows]
            if aim.density is None:
                factor = np.pi / p
            else:
                p, q = p * aim.density, np.where(aim.is_found, found.density[rows], 0.0)
                factor = np.where(np.isfinite(p) & (p > 0.0), p / (p * p + q * q), 0.0)
            of_rows = found.all[rows] * aim.light * factor[:, None]
            bright = np.flatnonzero(of_rows.any(axis=1))
            if aim.way is not None and len(bright):
                places = rows[bright]
                start = self.leaving(rays[places], axes[2][places], l[places])
                of_rows[bright] *= self.faces.transmission(start, aim.way[bright], aim.limit)
            value[rows] = of_rows
        share = np.where((rays.depth == 0)[:, None], found.share(), rays.direct)
        self.add(rays, value, share)

    def onto(self, rays, lobes, axes, local, is_diffuse, is_chosen):
        """Returns the paths that go on in the directions of the frame that are chosen."""
        l = outward(axes, local)
        found = self.scattered(rays, lobes, axes, l)
        density = np.where(found.density > 0.0, found.density, 1.0)
        beta = rays.beta * found.all / density[:, None]
        goes_on = is_chosen & (found.density > 0.0) & beta.any(axis=1)
        may_end = rays.depth >= ROULETTE
        most = np.minimum(MOST, beta.max(axis=1))
        u, _ = self.pairs.at(rays.depth, pairs.ROULETTE, rays.number)
        goes_on &= ~may_end | (u < most)
        beta = np.where(may_end[:, None], beta / np.where(most > 0.0, most, 1.0)[:, None], beta)
        return rays.replaced(
            start=self.leaving(rays, axes[2], l),
            d=l,
            origin=rays.start.p,
            beta=beta,
            q=found.density,
            share=found.share(),
            direct=np.where((rays.depth == 0)[:, None], found.share(), rays.direct),
            depth=rays.depth + 1,
            diffuse_depth=rays.diffuse_depth + is_diffuse,
            has_scattered=np.ones(len(rays), bool),
            is_caustic=np.zeros(len(rays), bool),
        )[goes_on]

    def sharp(self, rays, start, d, factor, is_solid):
        """Returns paths that go on from mirrors or smooth glass."""
        return rays.replaced(
            start=start,
            d=d,
            origin=rays.start.p,
            beta=rays.beta * factor,
            q=np.full(len(rays), np.inf),
            share=np.zeros_like(rays.share),
            direct=np.where((rays.depth == 0)[:, None], 0.0, rays.direct),
            depth=rays.depth + 1,
            is_caustic=rays.is_caustic | rays.has_scattered & is_solid,
        )

    def mirrored_by(self, rays, n, factor, is_solid):
        d = rays.d - 2.0 * dots(rays.d, n)[:, None] * n
        return self.sharp(rays, rays.start, d, factor, is_solid)

    def opaque(self, rays):
        """Yields the paths that go on from opaque surfaces."""
        kinds = self.kinds[rays.start.own]
        for kind in np.unique(kinds):
            yield from self.of_material(rays[kinds == kind], self.materials[kind])

    def of_material(self, rays, material):
        v, n = self.facing(rays.start, rays.d)
        axes = frame(n)
        shown = copy.copy(material)
        if material.texture is not None:
            shown.color = self.first(rays.start)
        lobes = Opaque(shown, inward(axes, v))
        if not lobes.is_mirror():
            self.named(rays, self.first(rays.start))
        goes_on = ~self.is_exhausted(rays)
        if not goes_on.all():
            yield from self.of_material(rays[goes_on], material) if goes_on.any() else ()
            return
        if lobes.is_mirror():
            after = self.mirrored_by(rays, n, lobes.mirror, True)
        else:
            self.lit(rays, lobes, axes)
            _, u = self.pairs.at(rays.depth, pairs.CHOICE, rays.number)
            pair = self.pairs.at(rays.depth, pairs.DIRECTION, rays.number)
            local, is_diffuse, is_mirror, factor = lobes.sample(u, pair)
            yield self.onto(rays, lobes, axes, local, is_diffuse, ~is_mirror)
            after = self.mirrored_by(rays, n, factor, True)[is_mirror]
        yield after[after.beta.any(axis=1)]

    # -----------------------------------------------------------------------------------------
    # Glass
    # -----------------------------------------------------------------------------------------

    def glassy(self, rays, met):
        """Yields the paths that go on from glass."""
        straight, is_pane, tint, ratio, start = self.interface(rays.start, *met)
        if straight.any():
            # Also where two pieces of equal glass meet: no light that is aimed gets through them.
            is_joint = (met[2] != light.NONE) & straight
            q = np.where(is_joint & self.caustics, np.inf, rays.q)
            origin = np.where(np.isfinite(q)[:, None], rays.origin, rays.start.p)
            on = rays.replaced(start=rays.start.through(rays.d), beta=rays.beta * tint, q=q, origin=origin)
            yield on[straight]
        rough = np.array([self.roughness_at(*each) for each in zip(*met[:2], met[3], is_pane)])
        rays = rays.replaced(start=start)
        is_rough = ~straight & (rough > 0.0) & (ratio != 1.0)
        kinds = np.stack([rough, 1.0 / ratio, is_pane], axis=1)
        for kind in np.unique(kinds[is_rough], axis=0):
            rows = is_rough & (kinds == kind).all(axis=1)
            self.named(rays[rows], self.first(rays.start[rows]))
            rows &= ~self.is_exhausted(rays)
            if rows.any():
                yield self.rough(rays[rows], tint[rows], kind)
        rows = ~straight & ~is_rough
        yield from self.smooth(rays[rows], is_pane[rows], tint[rows], ratio[rows])

    def roughness_at(self, left, entered, pane, is_pane):
        """Returns the α of a surface between two media: that of the rougher one."""
        of = [pane] if is_pane else [left, entered]
        return max([self.alphas[face] for face in of if face != light.NONE], default=0.0)

    def rough(self, rays, tint, kind):
        alpha, eta, is_pane = kind
        v, n = self.facing(rays.start, rays.d)
        axes = frame(n)
        lobes = RoughGlass(alpha, eta, bool(is_pane), tint, inward(axes, v))
        self.lit(rays, lobes, axes)
        _, u = self.pairs.at(rays.depth, pairs.CHOICE, rays.number)
        local, is_right = lobes.sample(u, self.pairs.at(rays.depth, pairs.DIRECTION, rays.number))
        return self.onto(rays, lobes, axes, local, np.zeros(len(rays), bool), is_right)

    def smooth(self, rays, is_pane, tint, ratio):
        v, n = self.facing(rays.start, rays.d)
        cos_i = dots(n, v)
        f, cos_t = fresnel(cos_i, ratio)
        _, u = self.pairs.at(rays.depth, pairs.CHOICE, rays.number)
        is_reflected = u < f
        goes_on = ~self.is_exhausted(rays)
        yield self.mirrored_by(rays, n, 1.0, ~is_pane)[is_reflected & goes_on]
        bent = ratio[:, None] * -v + (ratio * cos_i - cos_t)[:, None] * n
        behind = rays.start.through(rays.d)
        yield self.sharp(rays, behind, bent, tint, True)[~is_reflected & ~is_pane & goes_on]
        # Through a pane, a path goes as if there were none, and a scattered one to lamps beyond its depth.
        after = self.sharp(rays, behind, rays.d, tint, False)
        after.q, after.share = rays.q, rays.share
        after.origin = np.where(np.isfinite(rays.q)[:, None], rays.origin, after.origin)
        yield after[~is_reflected & is_pane & (goes_on | rays.has_scattered)]

    # -----------------------------------------------------------------------------------------
    # Paths
    # -----------------------------------------------------------------------------------------

    def step(self, rays):
        """Adds the light at the ends of rays, and yields how the paths go on."""
        t, arrived, sense = self.reached(rays.start, rays.d)
        self.passed(rays, t)
        hits = np.isfinite(t)
        self.escaped(rays[~hits])
        self.is_covered[rays.number[hits]] = True
        rays = rays.replaced(start=arrived)[hits]
        if not len(rays):
            return
        kinds, start, met = self.surfaces(rays.start, sense[hits])
        rays = rays.replaced(start=start)
        is_opaque = np.ones(len(rays), bool)
        for kind in ("Flat", "Emissive"):
            if (kinds == kind).any():
                self.shone(rays[kinds == kind], kind == "Emissive")
            is_opaque &= kinds != kind
        is_glass = kinds == "Glass"
        if is_glass.any():
            yield from self.glassy(rays[is_glass], [each[is_glass] for each in met])
        yield from self.opaque(rays[is_opaque & ~is_glass])

    def paths(self, o, d, numbers):
        """Returns the layers, of which each path has a row."""
        count = len(o)
        self.pairs, self.light = numbers, np.zeros((count, 2, 2, 3))
        self.albedo, self.has_albedo = np.zeros((count, 3)), np.zeros(count, bool)
        self.is_covered = np.zeros(count, bool)
        rays = Rays(
            start=self.faces.nowhere(o),
            d=d,
            origin=o,
            beta=np.ones((count, 3)),
            q=np.full(count, np.inf),
            share=np.zeros((count, 3)),
            direct=np.ones((count, 3)),
            depth=np.zeros(count, int),
            diffuse_depth=np.zeros(count, int),
            has_scattered=np.zeros(count, bool),
            is_caustic=np.zeros(count, bool),
            number=np.arange(count),
        )
        # A path goes straight on through glass without getting deeper.
        for _ in range(4 * (self.max_depth + 16)):
            after = [each for each in self.step(rays) if len(each)]
            if not after:
                break
            rays = joined(after)
        first, later = self.light[:, 0], self.light[:, 1]
        most = later.sum(axis=1).max(axis=1)
        whole = first + later * np.where(most > self.clamp, self.clamp / most, 1.0)[:, None, None]
        return dict(zip(LAYERS, (whole[:, 0], whole[:, 1], self.albedo, self.is_covered)))


def place_in_pixel(described, u, v):
    """Returns the places of samples relative to the centers of their pixels."""
    name, fields = variant(described)
    if name == "Box":
        return u - 0.5, v - 0.5
    radius = float(optional(fields, "sigma", 0.5)) * np.sqrt(-2.0 * np.log(u))
    cos, sin = pairs.circle(v)
    return radius * cos, radius * sin


def through_lens(camera, o, d, u, v):
    """Returns rays that start on the lens of a camera and meet those through its middle where it is sharp."""
    _, fields = variant(camera)
    aperture = float(optional(fields, "aperture", 0.0))
    if aperture == 0.0:
        return o, d
    e, right, up, back, _, _ = (np.array(each) for each in evaluate.basis(fields))
    focus = optional(fields, "focus", None)
    if focus is None:
        at = fields.get("focus_at") or fields["look_at"]
        focus = (np.array(at, float) - e) @ -back
    x, y = pairs.disc(u, v)
    shift = aperture / 2.0 * (x[:, None] * right + y[:, None] * up)
    return o + shift, units(d * (focus / (d @ -back))[:, None] - shift)


def backdrop_of(described):
    """Returns what is seen in place of the background: it looks like the light of the same."""
    if described is None:
        return None
    name, fields = variant(described)
    return Environment(fields if name == "Image" else {"sky": fields, "up": optional(fields, "up", textures.UP)})


def read_scene(path):
    """Returns a scene with the pictures of its surroundings and of its textures."""
    scene = evaluate.read_scene(path)
    folder = os.path.dirname(path)
    materials = [variant(material)[1] for material in optional(scene, "materials", {}).values()]
    for geometry in scene["geometries"]:
        _, fields = variant(geometry)
        materials.append(fields)
        if fields.get("material") is not None and isinstance(variant(fields["material"])[1], dict):
            materials.append(variant(fields["material"])[1])
    for described in [each.get("texture") for each in materials] + [scene.get("backdrop")]:
        if described is not None:
            textures.read(described, folder)
    for light in scene.get("lights") or []:
        _, fields = variant(light)
        if fields.get("image"):
            fields["texels"] = textures.read_pfm(os.path.join(folder, fields["image"]))
    return scene


def evaluate_paths(scene, aside=0.0):
    """Returns the layers, from the top row downwards, with directions of the camera that are changed by `aside`."""
    np.seterr(all="ignore")
    world = World(scene)
    width, height = evaluate.size_of(scene)
    y, x, sample = (each.ravel() for each in np.mgrid[:height, :width, : world.samples])
    numbers = Pairs(x, y, sample, world.seed)
    right, up = place_in_pixel(world.filter, *numbers.pair(pairs.PLACE))
    ray = evaluate.camera_rays(scene["camera"], float(width), float(height))
    rays = [ray(*place) for place in zip((x + right).tolist(), (y + up).tolist())]
    o, d = (np.array(values) for values in zip(*rays))
    o, d = through_lens(scene["camera"], o, d, *numbers.pair(pairs.LENS))
    found = world.paths(o, d + aside, numbers)
    shape = height, width, world.samples
    return {name: layer.reshape(*shape, *layer.shape[1:]).mean(axis=2)[::-1] for name, layer in found.items()}


def differences(expected, found):
    """Returns how much each pixel differs."""
    shape = (*found["coverage"].shape, -1)
    off = {name: np.abs(expected[name] - found[name]).reshape(shape).sum(axis=2) for name in LAYERS}
    light_off = off["direct"] + off["specular"]
    whole = np.abs(found["direct"] + found["specular"]).sum(axis=2)
    light_off = np.where(light_off > 0.0, light_off / np.maximum(whole, 1e-300), light_off)
    return np.maximum(light_off, np.maximum(off["albedo"], off["coverage"]))


def check(path, layers):
    """Returns the layers of a scene, those of a file, and how much their pixels differ."""
    with np.load(layers) as file:
        found = {name: file[name] for name in LAYERS}
    expected = evaluate_paths(read_scene(path))
    return expected, found, differences(expected, found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--layers", metavar="NPZ", required=True, help="the layers direct and specular of the program")
    options = parser.parse_args()
    expected, found, off = check(options.scene, options.layers)
    wrong = np.argwhere(~(off <= TOLERANCE))
    for row, column in wrong[:10].tolist():
        print(f"column {column}, row {row}: off by {off[row, column]:.3g}")
        for name in LAYERS:
            a, b = (layers[name][row, column].tolist() for layers in (expected, found))
            print(f"  {name}: {b}, the equations give {a}")
    most = off[off <= TOLERANCE].max(initial=0.0)
    print(f"{off.size} pixels, {len(wrong)} differ; the others by {most:.1g} at most")
    return 1 if len(wrong) > TOLERATED * off.size else 0


if __name__ == "__main__":
    sys.exit(main())
