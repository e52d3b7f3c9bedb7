#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes models/car.glb and models/crate.glb beside this file, always the same bytes.

Metres, glTF axes (y up), origin on the floor under the middle; the car drives along x.
"""
import json
import math
import pathlib
import struct
import zlib


def box(x0, x1, y0, y1, z0, z1, top=1.0):
    """Triangles of a box; its top is drawn in towards the middle by the factor `top`."""
    xm = (x0 + x1) / 2
    def corner(right, up, front):
        x, z = (x1 if right else x0), (z1 if front else z0)
        return (xm + (x - xm) * top, y1, z * top) if up else (x, y0, z)
    p = [corner(i & 1, i & 2, i & 4) for i in range(8)]
    quads = [(4, 5, 7, 6), (1, 0, 2, 3), (5, 1, 3, 7), (0, 4, 6, 2), (6, 7, 3, 2), (0, 1, 5, 4)]
    return [[p[a], p[b], p[c]] for q in quads for a, b, c in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def wheel(x, z, radius, width, corners=20):
    """Triangles of a wheel that stands on the floor, its axle along z."""
    ring = [(x + radius * math.cos(2 * math.pi * i / corners),
             radius + radius * math.sin(2 * math.pi * i / corners)) for i in range(corners)]
    near, far = z + width / 2, z - width / 2
    triangles = []
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
        triangles += [[(x, radius, near), (ax, ay, near), (bx, by, near)],
                      [(x, radius, far), (bx, by, far), (ax, ay, far)],
                      [(ax, ay, near), (ax, ay, far), (bx, by, far)],
                      [(ax, ay, near), (bx, by, far), (bx, by, near)]]
    return triangles


def planks(size=64):
    """PNG bytes of boards with dark joints and a frame."""
    rows = b""
    for y in range(size):
        rows += b"\0"
        for x in range(size):
            edge = min(x, y, size - 1 - x, size - 1 - y)
            grain = (37 * x + 11 * ((x * x + 7 * y) % 13) + 3 * (y // 2)) % 24
            shade = 150 + grain if edge < 7 else 178 + grain - 30 * ((y // 10) % 2)
            if edge == 7 or (edge > 7 and y % 10 == 0):
                shade = 70
            rows += bytes((shade, int(shade * 0.72), int(shade * 0.45)))
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


class Glb:
    """Collects buffer views, accessors and primitives."""

    def __init__(self):
        self.binary, self.views, self.accessors, self.primitives, self.materials = b"", [], [], [], []

    def view(self, data):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        return len(self.views) - 1

    def accessor(self, rows, kind):
        flat = [value for row in rows for value in row]
        entry = {"bufferView": self.view(struct.pack(f"<{len(flat)}f", *flat)), "componentType": 5126,
                 "count": len(rows), "type": kind}
        if kind == "VEC3":
            entry["min"] = [min(column) for column in zip(*struct_floats(rows))]
            entry["max"] = [max(column) for column in zip(*struct_floats(rows))]
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def part(self, triangles, color, uv=None, texture=None):
        surface = {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0}
        if texture is not None:
            surface["baseColorTexture"] = {"index": texture}
        self.materials.append({"pbrMetallicRoughness": surface})
        attributes = {"POSITION": self.accessor([p for t in triangles for p in t], "VEC3")}
        if uv:
            attributes["TEXCOORD_0"] = self.accessor(uv, "VEC2")
        self.primitives.append({"attributes": attributes, "material": len(self.materials) - 1})

    def write(self, path, **more):
        document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                    "nodes": [{"mesh": 0}], "meshes": [{"primitives": self.primitives}],
                    "materials": self.materials, "accessors": self.accessors, "bufferViews": self.views, **more}
        self.binary += b"\0" * (-len(self.binary) % 4)
        document["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = (struct.pack("<I4s", len(text), b"JSON") + text +
                  struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def struct_floats(rows):
    """The rows as 32-bit floats hold them, so that min and max are exact."""
    return [struct.unpack(f"<{len(row)}f", struct.pack(f"<{len(row)}f", *row)) for row in rows]


def make_car(path):
    car = Glb()
    car.part(box(-0.50, 0.50, 0.08, 0.26, -0.23, 0.23, 0.94), (0.55, 0.03, 0.03))
    car.part(box(-0.28, 0.24, 0.26, 0.44, -0.20, 0.20, 0.72), (0.10, 0.14, 0.18))
    car.part([t for z in (-0.14, 0.14) for t in box(0.48, 0.505, 0.16, 0.21, z - 0.04, z + 0.04)], (0.9, 0.85, 0.6))
    car.part([t for x in (-0.30, 0.30) for z in (-0.22, 0.22) for t in wheel(x, z, 0.10, 0.07)], (0.02, 0.02, 0.02))
    car.write(path)


def make_crate(path):
    crate = Glb()
    triangles = box(-0.3, 0.3, 0.0, 0.6, -0.3, 0.3)
    corners = [(0, 1), (1, 1), (1, 0), (0, 1), (1, 0), (0, 0)]
    picture = crate.view(planks())
    crate.part(triangles, (1.0, 1.0, 1.0), corners * 6, texture=0)
    crate.write(path, textures=[{"source": 0}], images=[{"bufferView": picture, "mimeType": "image/png"}])


if __name__ == "__main__":
    folder = pathlib.Path(__file__).resolve().parent / "models"
    folder.mkdir(exist_ok=True)
    make_car(folder / "car.glb")
    make_crate(folder / "crate.glb")
