#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of docs/method/compositor.md: what goes into a pass and what comes out of it,
for one frame of one take of the virtual studio.

    docs/images/make_passes.py --mixrig build/release/host/tools/mixrig

The take is kept in --cache and used again. ffmpeg scales the strips and writes them as JPEG."""
import argparse
import struct
import subprocess
import zlib
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCENARIO, SEED, RIG, SIZE, FRAMES = "walk", 11, "kinect2", "640x512", 44
SHOWN, EMPTY = 38, 20  # frames of the take: with a person, and of the empty room
BEFORE = 3             # frames that are composited before it, since the matte depends on them
GAP_PX = 8             # white, between the pictures of a strip
NEAR_M, FAR_M = 1.5, 5.5  # ends of the colours of depth


class Picture:
    """Rows of pixels of three bytes."""

    def __init__(self, width, height, rows):
        self.width, self.height, self.rows = width, height, rows

    def crop(self, box):
        x, y, width, height = box
        return Picture(width, height,
                       [row[3 * x:3 * (x + width)] for row in self.rows[y:y + height]])

    def enlarged(self, factor):
        """Each pixel as a square."""
        rows = []
        for row in self.rows:
            wide = b"".join(row[i:i + 3] * factor for i in range(0, len(row), 3))
            rows += [wide] * factor
        return Picture(self.width * factor, self.height * factor, rows)


def unfiltered(data, stride, height, step):
    """Rows of a PNG file, whose filters are undone."""
    rows, before = [], bytearray(stride)
    for y in range(height):
        kind, row = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = row[i - step] if i >= step else 0
            up, corner = before[i], before[i - step] if i >= step else 0
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + up) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + up) // 2) & 255
            elif kind == 4:
                to_left, to_up = abs(up - corner), abs(left - corner)
                to_corner = abs(left + up - 2 * corner)
                near = left if to_left <= to_up and to_left <= to_corner else \
                    up if to_up <= to_corner else corner
                row[i] = (row[i] + near) & 255
        rows.append(row)
        before = row
    return rows


def color_of_depth(mm):
    """Red is near, blue is far, black is unknown."""
    if mm == 0:
        return b"\0\0\0"
    at = min(max((FAR_M - mm / 1000) / (FAR_M - NEAR_M), 0), 1) * 4
    knots = [(48, 18, 120), (40, 120, 220), (70, 200, 130), (245, 200, 60), (210, 40, 30)]
    i = min(int(at), 3)
    return bytes(round(a + (at - i) * (b - a)) for a, b in zip(knots[i], knots[i + 1]))


def load(path):
    """A PNG of 8 bits, grey or colour, or of depth (16 bits, millimetres)."""
    data, at, packed = Path(path).read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", data[at + 8:at + 18])
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += length + 12
    step = (3 if color == 2 else 1) * bits // 8
    rows = unfiltered(zlib.decompress(packed), width * step, height, step)
    if bits == 16:
        table = {}
        for row in rows:
            for mm, in struct.iter_unpack(">H", row):
                if mm not in table:
                    table[mm] = color_of_depth(mm)
        rows = [b"".join(table[mm] for mm, in struct.iter_unpack(">H", row)) for row in rows]
    elif color == 0:
        rows = [b"".join(row[i:i + 1] * 3 for i in range(width)) for row in rows]
    return Picture(width, height, [bytes(row) for row in rows])


def padded(picture, height):
    """With white above and below."""
    white = b"\xff" * (3 * picture.width)
    above = (height - picture.height) // 2
    return [white] * above + picture.rows + [white] * (height - picture.height - above)


def write_strip(name, pictures, width_px):
    height = max(p.height for p in pictures)
    gap = b"\xff" * (3 * GAP_PX)
    rows = [gap.join(parts) for parts in zip(*(padded(p, height) for p in pictures))]
    wide = sum(p.width for p in pictures) + GAP_PX * (len(pictures) - 1)
    ppm = f"P6 {wide} {height} 255\n".encode() + b"".join(rows)
    out = HERE / f"pass_{name}.jpg"
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "image2pipe", "-c:v", "ppm", "-i", "-",
                    "-vf", f"scale={width_px}:-2:flags=area", "-q:v", "4", out],
                   input=ppm, check=True)
    print(f"{out.name}: {out.stat().st_size // 1024} KiB")


class Runs:
    def __init__(self, mixrig, cache):
        self.mixrig, self.cache = mixrig, cache
        self.take = cache / f"{SCENARIO}-{SEED}-{RIG}-{SIZE}"
        if not (self.take / "take.toml").exists():
            self.call("studio", self.take, "--scenario", SCENARIO, "--seed", SEED, "--rig", RIG,
                      "--size", SIZE, "--frames", FRAMES)
        self.scene = (self.take / "scene.toml").read_text()

    def call(self, *words):
        subprocess.run([self.mixrig, *map(str, words)], check=True, stdout=subprocess.DEVNULL)

    def run(self, name, scene, frame=SHOWN, before=BEFORE):
        """Folder of the pictures of a frame, and their number in it."""
        path, out = self.take / f"scene_{name}.toml", self.cache / name
        path.write_text(scene)
        self.call("run", path, "--source", f"take:{self.take}", "--backend", "cpu", "--frames",
                  f"{frame - before}-{frame}", "--layers", "--inspect", "--out", out)
        return lambda image: load(out / image / f"{before + 1:06}.png")

    def taken(self, image, frame=SHOWN):
        return load(self.take / image / f"{frame:06}.png")


def without_object(scene):
    head, rest = scene.split("[[object]]")
    return head + rest[rest.index("[light]"):]


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--mixrig", required=True)
    p.add_argument("--cache", type=Path, default=Path("out/passes"))
    args = p.parse_args()
    args.cache.mkdir(parents=True, exist_ok=True)
    runs = Runs(args.mixrig, args.cache)
    person, table, edge = (165, 90, 240, 400), (60, 200, 160, 130), (285, 190, 120, 100)

    plate = runs.taken("color")
    mixed = runs.run("mixed", runs.scene)
    composite, depth = mixed("composite/color"), mixed("composite/depth")
    write_strip("warp", [runs.taken("depth"), mixed("warped_depth")], 1000)
    write_strip("light", [plate, mixed("light"), composite], 1200)

    empty = runs.run("empty", runs.scene, EMPTY, 0)
    learned = runs.run("learned", without_object(runs.scene), EMPTY, 0)
    write_strip("background", [image.crop(table).enlarged(3) for image in
                               (runs.taken("color", EMPTY), learned("composite/depth"),
                                empty("composite/depth"))], 1000)

    alone = runs.run("alone", runs.scene + "\n[set]\n", EMPTY, 0)
    objects = alone("composite/color")
    write_strip("virtual", [objects, alone("alpha"), alone("composite/depth")], 1200)
    write_strip("mix", [plate, mixed("matte"), objects, composite, depth], 1400)

    level = lambda key: runs.run(key, runs.scene + f'\n[quality]\nkey = "{key}"\n')
    write_strip("key", [image.crop(person) for image in
                        (plate, level("plain")("matte"), level("votes")("matte"), mixed("matte"))],
                1000)

    look = "\n[look]\n" + "".join(f"{k} = true\n" for k in ("grain", "blur", "chroma", "sharpening"))
    seen = runs.run("look", runs.scene + look)("composite/color")
    write_strip("look", [image.crop(edge).enlarged(4) for image in (composite, seen)], 900)

    focus = runs.run("focus", runs.scene + "\n[focus]\ndistance_m = 2.2\nf_number = 0.5\n")
    write_strip("focus", [composite, depth, focus("composite/color")], 1200)


if __name__ == "__main__":
    main()
