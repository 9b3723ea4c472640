#!/usr/bin/env python3
"""Opens the layers that the program writes with other packages, and compares them.

    layers.py target/release/strahl scenes/molecule.ron

The same layers go into an .exr and an .npz file. OpenEXR must read the same values from one as NumPy
from the other, under the standard names; the Cryptomatte channels must contain the same ids, as the
mmh3 hashes of the names in the manifest.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import mmh3
import numpy
import OpenEXR

LAYERS = "color,depth,z,position,normal,id,coverage"


def render(program, scene, path, *options):
    command = [program, "render", scene, "-q", "-o", path, "--layers", LAYERS, "--samples", "16"]
    subprocess.run([*command, *options], check=True)


def matte(name):
    """Returns the float of a name, by the specification of Cryptomatte 1.2.0."""
    bits = mmh3.hash(name, signed=False)
    if bits >> 23 & 255 in (0, 255):
        bits ^= 1 << 23
    return numpy.uint32(bits)


def check(program, scene, folder):
    exr, npz = folder / "a.exr", folder / "a.npz"
    for tool in ("exrheader", "exrinfo"):
        render(program, scene, exr)
        subprocess.run([tool, exr], check=True, stdout=subprocess.DEVNULL)
    render(program, scene, npz, "--bits", "32")
    # Without separate_channels OpenEXR would make one array of R, G, B and A.
    with OpenEXR.File(str(exr), separate_channels=True) as file:
        # Both are gone once the file is closed.
        header = dict(file.header())
        channels = {name: channel.pixels.copy() for name, channel in file.channels().items()}
    arrays = numpy.load(npz)
    single = numpy.float32
    expected = {"A": arrays["coverage"], "Z": arrays["depth"], "planar.Z": arrays["z"]}
    for axis, name in enumerate("XYZ"):
        expected[f"P.{name}"] = arrays["position"][..., axis]
        expected[f"N.{name}"] = arrays["normal"][..., axis]
    for channel, name in enumerate("RGB"):
        expected[name] = arrays["color"][..., channel]
    for name, values in expected.items():
        assert channels[name].dtype == single, name
        assert numpy.array_equal(channels[name], values.astype(single)), name
    ids = channels["id"]
    assert ids.dtype == numpy.uint32
    assert numpy.array_equal(ids + numpy.uint32(1), arrays["id"]), "ids"

    layer = next(key for key in header if key.startswith("cryptomatte/") and key.endswith("/name"))
    key = layer.removesuffix("/name")
    assert header[layer] == "CryptoObject"
    assert key == f"cryptomatte/{mmh3.hash(header[layer], signed=False):08x}"[: len("cryptomatte/") + 7]
    assert header[f"{key}/hash"] == "MurmurHash3_32"
    assert header[f"{key}/conversion"] == "uint32_to_float32"
    manifest = json.loads(header[f"{key}/manifest"])
    for name, digits in manifest.items():
        assert int(digits, 16) == matte(name), name
    names = list(manifest)
    whole = arrays["coverage"] == 1.0
    first = channels["CryptoObject00.r"].view(numpy.uint32)
    alone = whole & (channels["CryptoObject00.g"] == 1.0)
    hashes = numpy.array([matte(name) for name in names])
    assert alone.any() and numpy.array_equal(first[alone], hashes[ids[alone]]), "mattes"
    levels = [f"CryptoObject{level:02}.{part}" for level in range(3) for part in "ga"]
    total = sum(channels[level] for level in levels)
    assert numpy.array_equal(total, arrays["coverage"].astype(single)), "what the mattes cover"
    parts = numpy.stack([channels[level] for level in levels])
    assert (numpy.diff(parts, axis=0) <= 0).all(), "the most first"
    assert ((channels["CryptoObject00.g"] > 0) & (channels["CryptoObject00.g"] < 1)).any()
    print(f"equal {scene}: {len(channels)} channels, {len(names)} names")


def main():
    program, *scenes = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            check(program, scene, Path(folder))


if __name__ == "__main__":
    main()
