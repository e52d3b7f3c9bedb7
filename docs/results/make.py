#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the page of figures, docs/results/figures.md, with plots and pictures: every scenario and
depth camera of the virtual studio, plain composites beside the compositor, the judged look and the
plain one, true and estimated calibration, true and wrong lamps.

    docs/results/make.py --mixrig build/release/host/tools/mixrig

Takes and runs are kept in --cache and used again."""
import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from page import Page
from takes import FULL_FRAMES, FULL_SIZE, MOVING, RIGS, ROOT, STILL, Workshop, drawn_seeds, seeds


def machine():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo")
             if line.startswith("model name")]
    return f"{len(names)} cores of {names[0]}"


def commit():
    words = lambda *w: subprocess.run(["git", "-C", ROOT, *w], capture_output=True,
                                      text=True).stdout.strip()
    dirty = words("status", "--porcelain", "--untracked-files=no", "--", "host", "hal")
    return words("rev-parse", "--short=10", "HEAD") + (" with changes" if dirty else "")


def collect(shop, chosen, calibrated):
    """Reports by (kind, scenario, rig, seed)."""
    runs = {}
    for seed in chosen:
        for scenario in STILL + MOVING:
            for rig in RIGS:
                take = shop.take(scenario, rig, seed)
                for lamps in ("true", "off"):
                    runs[lamps, scenario, rig, seed] = shop.run(take, lamps)
                runs["plain", scenario, rig, seed] = shop.run(
                    shop.take(scenario, rig, seed, plain=True))
    for seed in calibrated:
        for scenario in ("walk", "pan"):
            for rig in RIGS:
                take = shop.take(scenario, rig, seed, tolerance=True)
                runs["known", scenario, rig, seed] = shop.run(take)
                if calibration := shop.calibration(rig, seed):
                    runs["estimated", scenario, rig, seed] = shop.run(take, calibration=calibration)
    for rig in RIGS[:2]:
        take = shop.take("walk", rig, chosen[0], FULL_SIZE, FULL_FRAMES)
        runs["full", "walk", rig, chosen[0]] = shop.run(take, baselines=False)
    return runs


# Pictures of the worst frames: name, what is large where it is bad.
WORST = {
    "key": lambda e: -(e["contested"]["key_iou"] if e["contested"]["key_iou"] is not None else 1),
    "order": lambda e: e["order_wrong_pct"] or 0,
    "shadow": lambda e: e["light_shadow_rmse"] or 0,
    "object": lambda e: e["object_rmse"] or 0,
}


def worst_pictures(shop, runs, out):
    pictures = []
    for name, judge in WORST.items():
        _, scenario, rig, seed = max((k for k in runs if k[0] == "true"),
                                     key=lambda k: judge(runs[k]["error"]))
        number, sheet = shop.worst_frame(shop.take(scenario, rig, seed), judge)
        shutil.copyfile(sheet, out / f"worst_{name}.png")
        pictures.append((name, scenario, rig, seed, number))
    return pictures


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--mixrig", default=ROOT / "build/release/host/tools/mixrig")
    parser.add_argument("--cache", default=ROOT / "out/figures")
    parser.add_argument("--out", default=ROOT / "docs/results", type=Path)
    parser.add_argument("--seeds", type=int, help="how many: of the list all by default, of --tag 2")
    parser.add_argument("--tuned", action="store_true",
                        help="the seeds that may be tuned on; give another --out")
    parser.add_argument("--takes", action="store_true",
                        help="only renders the takes, so that the runs can be timed on an idle machine")
    parser.add_argument("--tag", help="version whose judged seeds are drawn, in place of the list")
    parser.add_argument("--dry", action="store_true", help="only prints the seeds")
    arguments = parser.parse_args()
    if arguments.tag and arguments.tuned:
        sys.exit("make.py: --tag draws judged seeds: leave out --tuned")
    if arguments.tuned and arguments.out.resolve() == (ROOT / "docs/results").resolve():
        sys.exit("make.py: the page shows judged seeds: give --tuned another --out")
    chosen = seeds("kTunedFigures" if arguments.tuned else "kFigures")[:arguments.seeds]
    if arguments.tag:
        chosen = drawn_seeds(arguments.tag, arguments.seeds or 2)
    calibrated = chosen[:1] if arguments.tuned or arguments.tag else seeds("kCalibratedFigures")
    if arguments.dry:
        print(*chosen)
        return
    shop = Workshop(arguments.mixrig, arguments.cache, arguments.takes)
    runs = collect(shop, chosen, calibrated)
    if arguments.takes:
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    pictures = worst_pictures(shop, runs, arguments.out)
    command = " ".join(["docs/results/make.py"] + (["--tuned"] if arguments.tuned else []) +
                       ([f"--tag {arguments.tag}"] if arguments.tag else []) +
                       ([f"--seeds {arguments.seeds}"] if arguments.seeds else []))
    page = Page(runs, chosen, calibrated, pictures,
                f"{machine()}, cpu back end; commit {commit()}; up to {shop.load():.0f} "
                f"processes running beside; made by `{command}`")
    page.write(arguments.out)


if __name__ == "__main__":
    main()
