#!/usr/bin/env python3
"""Opens the image files that the tests write with other programs and packages.

    check.py FOLDER

The files are those of `src/image_file/tests/files.rs`, which also defines the numbers of a
picture. The name of a file gives its contents: `rgb-u1-fast.png` has three integers of one byte.
"""

import json
import pathlib
import shutil
import struct
import subprocess
import sys
import zipfile

import mmh3
import numpy as np
import OpenEXR
import tifffile
from PIL import Image

WIDTH, HEIGHT = 37, 21
PARTS = {"gray": 1, "rgb": 3, "rgba": 4}
PALETTE = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9], [200, 100, 0], [0, 0, 255]], np.uint8)
CHANNELS = {
    "R": "f2", "G": "f2", "B": "f2", "A": "f2", "Z": "f4", "N.X": "f4", "id": "u4",
    "a name that is longer than others": "f4",
}  # fmt: skip
CRYPTOMATTE = [f"CryptoObject{level:02}.{part}" for level in range(3) for part in "rgba"]
COMPRESSIONS = {
    "none": OpenEXR.NO_COMPRESSION, "rle": OpenEXR.RLE_COMPRESSION,
    "zips": OpenEXR.ZIPS_COMPRESSION, "zip": OpenEXR.ZIP_COMPRESSION,
    "fast": OpenEXR.ZIP_COMPRESSION, "small": OpenEXR.ZIP_COMPRESSION,
}  # fmt: skip
CHROMATICITIES = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)


def plane(kind, part, color):
    """Returns the numbers of one channel of a pixel."""
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    number = column // 4 * 31 + row // 3 * 17 + part * 101
    if kind[0] == "f":
        number = number / 8.0
        first = np.inf
    else:
        number = number * {1: 1, 2: 257, 4: 65537}[int(kind[1])]
        first = 0xFFFFFFFF if kind == "u4" else number[0, 0]
    if not color:
        number[0, 0] = first
    return (number if kind[0] == "f" else number % 2 ** (8 * int(kind[1]))).astype("<" + kind)


def picture(layout, kind):
    """Returns the numbers of a picture: rows, columns and, for colors, channels."""
    count = PARTS[layout]
    planes = [plane(kind, part, count > 1) for part in range(count)]
    return planes[0] if count == 1 else np.stack(planes, axis=-1)


def expect(right, what):
    if not right:
        sys.exit(f"wrong: {what}")


def same(found, expected, what):
    found = np.asarray(found)
    expect(found.shape == expected.shape, f"{what}: {found.shape}, expected {expected.shape}")
    expect(found.dtype == expected.dtype, f"{what}: {found.dtype}, expected {expected.dtype}")
    expect((found == expected).all(), f"{what}: the numbers differ")


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    expect(done.returncode == 0, f"{command}: {done.stdout}{done.stderr}")
    return done.stdout


def check_png(path, layout, kind):
    run("pngcheck", "-q", path)
    if layout == "indexed":
        row, column = np.mgrid[:HEIGHT, :WIDTH]
        expected = PALETTE[(column // 4 + row // 3) % len(PALETTE)]
        return same(Image.open(path).convert("RGB"), expected, path)
    expected = picture(layout, kind)
    if kind == "u2" and layout != "gray":
        # Pillow reads only 8 bits of these.
        expected = (expected >> 8).astype("u1")
    same(np.asarray(Image.open(path)).astype(expected.dtype), expected, path)


def check_tiff(path, layout, kind):
    same(tifffile.imread(path), picture(layout, kind), path)
    with tifffile.TiffFile(path) as file:
        tags = file.pages[0].tags
        expect(tags["Orientation"].value == 1, path)
        expect(("ExtraSamples" in tags) == (layout == "rgba"), path)
    if kind == "u1":
        same(Image.open(path), picture(layout, kind), path)


def check_pillow(path, layout, kind):
    same(Image.open(path).convert("RGBA" if layout == "rgba" else "RGB"), picture(layout, kind), path)


def check_space(path):
    # Exif's directory and its tag ColorSpace, where 1 is sRGB.
    expect(Image.open(path).getexif().get_ifd(0x8769).get(0xA001) == 1, f"{path}: not said to be sRGB")


def check_webp(path, layout, kind):
    check_pillow(path, layout, kind)
    check_space(path)


def check_jpg(path, layout, kind):
    check_space(path)
    found = np.asarray(Image.open(path)).astype(int)
    far = np.abs(found - picture(layout, kind)).mean()
    expect(far < 16, f"{path}: far from the picture by {far}")


def check_ppm(path, layout, kind):
    header, pixels = path.read_bytes()[:-WIDTH * HEIGHT * 3 * int(kind[1])], None
    expect(header == b"P6\n37 21\n%d\n" % (256 ** int(kind[1]) - 1), path)
    pixels = np.fromfile(path, ">" + kind, offset=len(header)).reshape(HEIGHT, WIDTH, 3)
    same(pixels.astype(kind), picture(layout, kind), path)


def check_pfm(path, layout, kind):
    expected = picture(layout, kind)
    name, size, scale, pixels = path.read_bytes().split(b"\n", 3)
    expect((name, size, scale) == (b"Pf" if layout == "gray" else b"PF", b"37 21", b"-1.0"), path)
    found = np.frombuffer(pixels, "<f4").reshape(expected.shape)
    same(found[::-1], expected, path)
    if layout == "gray":
        same(Image.open(path), expected, path)


def check_hdr(path, layout, kind):
    """Decodes Radiance's run-length encoding, as described by its reader."""
    data = path.read_bytes()
    header, data = data.split(b"\n\n", 1)
    expect(header.startswith(b"#?RADIANCE\n") and b"FORMAT=32-bit_rle_rgbe" in header, path)
    size, data = data.split(b"\n", 1)
    expect(size == b"-Y 21 +X 37", path)
    at, rows = 0, []
    for _ in range(HEIGHT):
        expect(data[at : at + 4] == struct.pack(">BBH", 2, 2, WIDTH), path)
        at, row = at + 4, bytearray()
        while len(row) < 4 * WIDTH:
            count = data[at]
            if count > 128:
                row += data[at + 1 : at + 2] * (count - 128)
                at += 2
            else:
                row += data[at + 1 : at + 1 + count]
                at += 1 + count
        rows.append(np.frombuffer(row, np.uint8).reshape(4, WIDTH).T)
    expect(at == len(data), path)
    rgbe = np.stack(rows).astype(float)
    found = rgbe[..., :3] * 2.0 ** (rgbe[..., 3:] - 136)
    expected = picture(layout, kind)
    far = np.abs(found - expected) / expected.max(axis=-1, keepdims=True).clip(1e-9)
    expect(far.max() <= 1 / 256, f"{path}: {far.max()}")


def check_exr(path, channels, compression):
    names = run("exrheader", path)
    run("exrinfo", "-s", path)
    if shutil.which("exrcheck"):
        # Not packaged on every system.
        run("exrcheck", path)
    for name in channels:
        expect(f"    {name}, " in names, f"{path}: exrheader does not show {name}")
    with OpenEXR.File(str(path), separate_channels=True) as file:
        expect(len(file.parts) == 1, path)
        header, found = file.header(), file.channels()
        expect(list(found) == sorted(channels), f"{path}: {list(found)}")
        expect(header["compression"] == compression, path)
        expect(np.allclose(header["chromaticities"], CHROMATICITIES), path)
        for part, (name, kind) in enumerate(channels.items()):
            same(found[name].pixels, plane(kind, part, False), f"{path} {name}")
        return dict(header)


def check_npy(path, layout, kind):
    same(np.load(path), picture(layout, kind), path)


def check_npz(path):
    with zipfile.ZipFile(path) as archive:
        expect(archive.testzip() is None, path)
        dates = {entry.date_time for entry in archive.infolist()}
        expect(dates == {(1980, 1, 1, 0, 0, 0)}, path)
    with np.load(path) as arrays:
        expect(arrays.files == ["color", "depth", "position"], path)
        same(arrays["color"], picture("rgb", "u1"), f"{path} color")
        same(arrays["depth"], picture("gray", "f4"), f"{path} depth")
        same(arrays["position"], picture("rgb", "f8"), f"{path} position")


def check_metadata(folder):
    camera = "Grüße\n2"
    lines = "Software: strahl 1", "Camera: Grüße 2"
    run("pngcheck", "-q", folder / "metadata.png")
    text = Image.open(folder / "metadata.png").text
    expect(text == {"Software": "strahl 1", "Camera": camera}, text)
    with tifffile.TiffFile(folder / "metadata.tiff") as file:
        tags = file.pages[0].tags
        expect(tags["Software"].value == "strahl 1", "metadata.tiff")
        expect(tags["ImageDescription"].value == "Camera: Grüße 2", "metadata.tiff")
    comments = [data.decode() for mark, data in Image.open(folder / "metadata.jpg").applist if mark == "COM"]
    expect(comments == list(lines), comments)
    header = (folder / "metadata.hdr").read_text(errors="replace").split("\n\n")[0].splitlines()
    expect(header[1:3] == [f"# {line}" for line in lines], header)
    check_hdr(folder / "metadata.hdr", "rgb", "f4")
    header = check_exr(folder / "metadata.exr", CHANNELS, OpenEXR.ZIP_COMPRESSION)
    expect((header["Software"], header["Camera"]) == ("strahl 1", camera), header)


def check_cryptomatte(path):
    header = check_exr(path, dict.fromkeys(CRYPTOMATTE, "f4"), OpenEXR.ZIP_COMPRESSION)
    key = f"cryptomatte/{mmh3.hash('CryptoObject', signed=False):08x}"[: len("cryptomatte/") + 7]
    expect(header[f"{key}/name"] == "CryptoObject", header)
    expect(header[f"{key}/hash"] == "MurmurHash3_32", header)
    expect(header[f"{key}/conversion"] == "uint32_to_float32", header)
    manifest = json.loads(header[f"{key}/manifest"])
    names = [f"name {count}" for count in range(1000)] + ['"Grüße" \\ 世界']
    expect(list(manifest) == names, "the names of the manifest")
    changed = 0
    for name, digits in manifest.items():
        bits = mmh3.hash(name, signed=False)
        if bits >> 23 & 255 in (0, 255):
            bits ^= 1 << 23
            changed += 1
        expect(digits == f"{bits:08x}", f"the number of {name}")
    expect(changed > 0, "no hash that is not an ordinary float")


def main():
    folder = pathlib.Path(sys.argv[1])
    checked = 0
    for path in sorted(folder.iterdir()):
        words, ending = path.stem.split("-"), path.suffix[1:]
        if words[0] in ("metadata", "cryptomatte"):
            continue
        checked += 1
        if ending == "exr":
            check_exr(path, CHANNELS, COMPRESSIONS[words[1]])
        elif ending == "npz":
            check_npz(path)
        else:
            check = {"bmp": check_pillow, "qoi": check_pillow}
            check.get(ending, globals().get(f"check_{ending}"))(path, words[0], words[1])
    expect(checked == 118, f"{checked} files")
    check_metadata(folder)
    check_cryptomatte(folder / "cryptomatte.exr")
    print(f"{checked + 6} files are as they should be")


if __name__ == "__main__":
    main()
