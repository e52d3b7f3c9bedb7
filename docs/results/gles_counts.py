#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/results/gles_counts.md: pixels, bytes and instructions of a frame of the gles back end.

usage: docs/results/gles_counts.py TAKE [--build build/release] [--name NAME]
TAKE is a take of mixrig studio; its truth is left out, since judged runs read more images back.
Needs the target gl_counts. Two runs, of two and of four frames, are subtracted, so that learning
and the start do not count.
"""
import argparse
import os
import re
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FIRST = 10
# Boards by what their memory moves, GB/s (theory), and Raspberry Pi 5's issue rate: 12 QPUs of 4
# lanes at 0.8 GHz.
MEMORY_GB_S = {"Pi 5": 17, "RK3588": 34, "Orin Nano": 68}
V3D_LANES_PER_S = 12 * 4 * 0.8e9


def without_truth(take, folder):
    for entry in take.iterdir():
        if entry.name not in ("truth", "take.toml"):
            (folder / entry.name).symlink_to(entry)
    parts = re.split(r"(?m)^(?=\[)", (take / "take.toml").read_text())
    (folder / "take.toml").write_text("".join(p for p in parts if not p.startswith("[truth")))
    return folder


def run(take, build, last):
    """Counts of a run: name -> draws, pixels, vertices, bytes read, bytes written."""
    with tempfile.NamedTemporaryFile() as out:
        environment = {**os.environ, "LD_PRELOAD": str(build / "tests/bench/libgl_counts.so"),
                       "GL_COUNTS": out.name, "GL_COUNTS_SHADERS": str(build / "shaders/expanded")}
        subprocess.run([build / "host/tools/mixrig", "run", take / "scene.toml", "--source",
                        f"take:{take}", "--backend", "gles", "--frames", f"{FIRST}-{last}"],
                       env=environment, check=True, stdout=subprocess.DEVNULL)
        rows = [line.split("\t") for line in Path(out.name).read_text().splitlines()]
    return {row[0]: [int(x) for x in row[1:]] for row in rows}


def instructions():
    """Name -> instructions of a pixel and of a vertex on V3D 7.1, by board_shaders.md.

    A vertex stage that several programs share stands with one of them; tilers run it twice.
    """
    rows = re.findall(r"(?m)^\| (\w+) \| (.*) \|$", (HERE / "board_shaders.md").read_text())
    counts = {name: [int(n) for n in re.findall(r"(\d+)/\d", text)] for name, text in rows}
    programs = (HERE.parent.parent / "tests/board_shaders/programs.txt").read_text()
    stages = {name: vertex for vertex, name in re.findall(r"(?m)^(\w+) (\w+) ", programs)}
    shared = {stages.get(name): sum(all[1:]) for name, all in counts.items() if len(all) > 1}
    return {name: (all[0], shared.get(stages.get(name), 0)) for name, all in counts.items() if all}


def page(name, rows):
    v3d = instructions()
    total_in = sum(r[3] for r in rows.values())
    total_out = sum(r[4] for r in rows.values())
    issued = {name: r[1] * v3d.get(name, (0, 0))[0] + r[2] * v3d.get(name, (0, 0))[1]
              for name, r in rows.items()}
    bounds = ", ".join(f"{board} {(total_in + total_out) / rate / 1e6:.0f} ms"
                       for board, rate in MEMORY_GB_S.items())
    lines = ["<!-- Made by docs/results/gles_counts.py -->",
             "# What a frame of the gles back end draws and moves",
             f"{name}, 1280x1024, a still camera, people and objects in the picture, the composite"
             " with its depths read back; the mean of two frames. A",
             "draw reads each texture of its program once, in the share of the target that it draws,"
             " and writes its pixels once. Pixels that",
             "leave early read less: bytes read are an upper limit with perfect caches. Instructions"
             " are V3D 7.1's of [the drivers' table](board_shaders.md),",
             "where a loop's body counts once; the vertices of warp, drawn indirectly, are not counted.", "",
             f"By memory alone: {bounds}. By instructions alone, Pi 5:"
             f" {1e3 * sum(issued.values()) / V3D_LANES_PER_S:.0f} ms.", "",
             "| program | draws | Mpixels | Mvertices | MB read | MB written | instructions a pixel, a"
             " vertex | Ginstructions |",
             "|---|---|---|---|---|---|---|---|",
             f"| **all** | {sum(r[0] for r in rows.values()):.0f} |"
             f" {sum(r[1] for r in rows.values()) / 1e6:.2f} |"
             f" {sum(r[2] for r in rows.values()) / 1e6:.2f} | {total_in / 1e6:.1f} |"
             f" {total_out / 1e6:.1f} | |"
             f" {sum(issued.values()) / 1e9:.2f} |"]
    for name, r in sorted(rows.items(), key=lambda item: -(item[1][3] + item[1][4])):
        count = ", ".join(str(n) for n in v3d.get(name, ()) if n)
        lines.append(f"| {name} | {r[0]:.0f} | {r[1] / 1e6:.2f} | {r[2] / 1e6:.2f} | {r[3] / 1e6:.1f} |"
                     f" {r[4] / 1e6:.1f} | {count} |"
                     f" {f'{issued[name] / 1e9:.2f}' if count else ''} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("take", type=Path)
    parser.add_argument("--build", type=Path, default=HERE.parent.parent / "build/release")
    parser.add_argument("--name", help="of the take on the page")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        take = without_truth(given.take.resolve(), Path(folder))
        few, more = (run(take, given.build.resolve(), FIRST + n) for n in (1, 3))
    rows = {name: [(m - f) / 2 for m, f in zip(counts, few.get(name, [0] * 5))]
            for name, counts in more.items()}
    rows = {name: counts for name, counts in rows.items() if counts[0] > 0}
    (HERE / "gles_counts.md").write_text(page(given.name or given.take.name, rows))


if __name__ == "__main__":
    main()
