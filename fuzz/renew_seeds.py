#!/usr/bin/env python3
"""Writes the seeds that depend on the version of the program: checkpoints, pictures, metadata.

Usage: fuzz/renew_seeds.py PROGRAM, from the root of the repository. Run it after a change of what
checkpoints or pictures record; the tests say when a seed is no longer accepted.
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

SEEDS = pathlib.Path("fuzz/seeds")
SCENE = """format = 1
[image]
width = 4
height = 3
[camera]
position = [0, 0, 6]
look_at = [0, 0, 0]
[background]
radiance = [1, 1, 1]
[materials.m]
type = "diffuse"
albedo = [0.5, 0.6, 0.7]
[[spheres]]
name = "ball"
center = [0, 0, 0]
radius = 1
material = "m"
"""


def render(folder, *words):
    """Renders the scene in the folder."""
    program = pathlib.Path(sys.argv[1]).resolve()
    # A scene without a file, so that no seed names a folder of this machine.
    command = [program, "render", "-", *words, "--quiet"]
    subprocess.run(command, cwd=folder, check=True, input=SCENE.encode())


def seed_name(file):
    """Returns a name that git does not ignore."""
    return file.replace(".", "-")


def shaped(part):
    """Returns the header line and the tiles of a part."""
    (length,) = struct.unpack_from("<I", part, 12)
    header = json.loads(part[16 : 16 + length])
    return json.dumps(header).encode() + b"\n" + part[16 + length + 32 : -32]


def texts(png):
    """Returns the metadata of a PNG file as names and texts that end with zero bytes."""
    at, found = 8, b""
    while at < len(png):
        (length,) = struct.unpack_from(">I", png, at)
        kind, body = png[at + 4 : at + 8], png[at + 8 : at + 8 + length]
        at += length + 12
        if kind not in (b"tEXt", b"zTXt", b"iTXt"):
            continue
        name, body = body.split(b"\0", 1)
        if kind == b"zTXt":
            body = zlib.decompress(body[1:])
        if kind == b"iTXt":
            is_packed, rest = body[0], body[2:].split(b"\0", 2)[2]
            body = zlib.decompress(rest) if is_packed else rest
        name = name.removeprefix(b"photosphere:")
        found += name + b"\0" + body + b"\0"
    return found


def main():
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        layers = ["--layers", "albedo,normal,depth,alpha,variance,crypto_sphere"]
        for kind, options in {
            "plain": ["--spp", "20"],
            "layers": ["--spp", "20", *layers],
            "range": ["--spp", "48", "--samples", "16..32"],
            "crop": ["--spp", "20", "--crop", "1,0,3,2"],
        }.items():
            render(folder, "-o", f"{kind}.part", *options)
            part = (folder / f"{kind}.part").read_bytes()
            (SEEDS / "checkpoint_shaped" / kind).write_bytes(shaped(part))
            if kind in ("plain", "layers"):
                (SEEDS / "checkpoint" / kind).write_bytes(part)
        for file, options in {
            "plain.png": [],
            "layers.exr": layers,
            "plain.hdr": [],
            "plain.pfm": [],
            "crop.exr": ["--crop", "1,0,3,2"],
        }.items():
            render(folder, "-o", file, "--spp", "4", "--no-run-figures", *options)
            (SEEDS / "picture" / seed_name(file)).write_bytes((folder / file).read_bytes())
        for name, options in {
            "plain": ["--spp", "4"],
            "paper": ["--integrator", "paper", "--tone", "agx"],
        }.items():
            render(folder, "-o", f"{name}.png", *options)
            records = texts((folder / f"{name}.png").read_bytes())
            (SEEDS / "metadata" / name).write_bytes(records)
        for file in ["sky.hdr", "sky.exr"]:
            render(folder, "-o", file, "--size", "8x4", "--spp", "4", "--no-run-figures")
            (SEEDS / "environment" / seed_name(file)).write_bytes((folder / file).read_bytes())


main()
