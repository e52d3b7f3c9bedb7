# SPDX-License-Identifier: Apache-2.0
"""Takes, calibrations and runs for the figures, kept in a cache by what made them."""
import hashlib
import json
import math
import os
import re
import subprocess
from pathlib import Path

from inputs import inputs_of

ROOT = Path(__file__).resolve().parents[2]
STILL = ["still", "walk", "talk", "edges", "far", "dark"]
MOVING = ["pan", "handheld", "pendulum"]
RIGS = ["kinect2", "sr3000", "helios2"]
FRAMES = {**{s: 20 for s in STILL}, **{s: 16 for s in MOVING}}  # half of them empty
SIZE = "320x256"
FULL_SIZE, FULL_FRAMES = "1280x1024", 16
BOARD_VIEWS = 12
LAMP_SHIFT_M, LAMP_FACTORS = 0.3, (1.3, 0.7)


def seeds(name):
    """A list of tests/support/seeds.h."""
    header = (ROOT / "tests/support/seeds.h").read_text()
    return [int(s) for s in re.search(name + r"\{([^}]*)\}", header).group(1).split(",")]


def spent_seeds():
    """The ranges kSpent of tests/support/seeds.h, as a set."""
    header = (ROOT / "tests/support/seeds.h").read_text()
    ranges = re.search(r"kSpent\{(.*?)\};", header, re.DOTALL).group(1)
    return {seed for first, last in re.findall(r"\{(\d+), (\d+)\}", ranges)
            for seed in range(int(first), int(last) + 1)}


def drawn_seeds(tag, count):
    """Judged seeds of a version, by a rule that nobody can choose by: SHA-256 of "TAG N" for N = 0,
    1, ..., its first 32 bits modulo a million, above 1000; spent seeds and repeats are left out."""
    spent, drawn, number = spent_seeds(), [], 0
    while len(drawn) < count:
        word = hashlib.sha256(f"{tag} {number}".encode()).hexdigest()[:8]
        seed = 1001 + int(word, 16) % 1_000_000
        if seed not in spent and seed not in drawn:
            drawn.append(seed)
        number += 1
    return drawn


def digest(paths):
    total = hashlib.sha256()
    for path in paths:
        total.update(path.read_bytes())
    return total.hexdigest()[:12]


class Workshop:
    """Calls the command; what it made before with the same arguments is used again. Takes are
    rendered anew when the studio's sources change, runs repeated when the command changes."""

    def __init__(self, mixrig, cache, only_takes=False, log=print):
        self.mixrig, self.only_takes, self.log = Path(mixrig).resolve(), only_takes, log
        studio = sorted((ROOT / "studio").rglob("*.[ch]*")) + [ROOT / "host/tools/studio_command.cpp"]
        self.takes = Path(cache).resolve() / ("takes-" + digest(studio))
        self.runs = Path(cache).resolve() / ("runs-" + digest([self.mixrig]))
        for folder in (self.takes, self.runs):
            folder.mkdir(parents=True, exist_ok=True)

    def call(self, *words):
        self.log("mixrig " + " ".join(map(str, words)))
        subprocess.run([self.mixrig, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
        if words[0] == "run":
            (self.runs / "load.txt").write_text(f"{max(self.load(), os.getloadavg()[0]):.1f}")

    def load(self):
        """The largest mean number of running processes while these runs were made."""
        file = self.runs / "load.txt"
        return float(file.read_text()) if file.exists() else 0.0

    def take(self, scenario, rig, seed, size=SIZE, frames=None, tolerance=False, plain=False):
        frames = frames or FRAMES[scenario]
        name = f"{scenario}-{rig}-{seed}-{frames}-{size}" + ("-tolerance1" if tolerance else "") + \
            ("-plain" if plain else "")
        out = self.takes / name
        if not (out / "take.toml").exists():
            self.call("studio", out, "--scenario", scenario, "--rig", rig, "--seed", seed,
                      "--frames", frames, "--size", size, *(["--tolerance", 1] if tolerance else []),
                      *(["--plain"] if plain else []))
        return out

    def calibration(self, rig, seed):
        """Estimated from boards that the cameras of this rig and seed see; None where they are refused."""
        out = self.runs / f"calibration-{rig}-{seed}.toml"
        boards = self.takes / f"boards-{rig}-{seed}"
        if not (boards / "views.toml").exists():
            self.call("studio", boards, "--scenario", "board", "--views", BOARD_VIEWS,
                      "--rig", rig, "--seed", seed, "--tolerance", 1, "--size", SIZE)
        if not out.exists():
            try:
                self.call("calibrate", "rig", boards, "--out", out)
            except subprocess.CalledProcessError:
                return None
        return out

    def run(self, take, condition="true", calibration=None, frames=None, baselines=True):
        """The report of a run, with `inputs`: what it knew. `condition`: "true" lamps, or lamps that are "off"."""
        if self.only_takes:
            return None
        name = "-".join([take.name, condition] + (["estimated"] if calibration else []) +
                        ([frames] if frames else []) + ([] if baselines else ["alone"]))
        report = self.runs / (name + ".json")
        scene = take / "scene.toml" if condition == "true" else wrong_lamps(take)
        if not report.exists():
            words = ["run", scene, "--source", f"take:{take}", "--backend", "cpu", "--format", "none",
                     "--out", self.runs / name, "--json", report]
            words += ["--calibration", calibration] if calibration else []
            words += ["--frames", f"{frames}-{frames}"] if frames else []
            self.call(*words, *(["--baselines"] if baselines else []))
        return json.loads(report.read_text()) | {"inputs": inputs_of(take, scene, calibration)}

    def worst_frame(self, take, judge, condition="true"):
        """Number and picture of the frame where `judge` (of its errors) is largest."""
        last = int(re.search(r"count = (\d+)", (take / "take.toml").read_text()).group(1))
        first = int(re.search(r"learn = \[1, (\d+)\]", (take / "scene.toml").read_text()).group(1))
        errors = {n: self.run(take, condition, frames=str(n))["error"]
                  for n in range(first + 1, last + 1)}
        worst = max(errors, key=lambda n: judge(errors[n]))
        folder = self.runs / f"{take.name}-{condition}-{worst}"
        return worst, folder / "contact_sheet.png"


def wrong_lamps(take):
    """The scene with every lamp 0.3 m aside, each in another direction, and by turns 30 % too
    bright and too dark."""
    lamp, out = -1, []
    for line in (take / "scene.toml").read_text().splitlines():
        lamp += line == "[[light.lamp]]"
        key, _, value = line.partition(" = ")
        if lamp >= 0 and key == "position_m":
            angle = math.pi / 4 + lamp * math.pi / 2
            x, y, z = json.loads(value)
            shifted = [x + LAMP_SHIFT_M * math.cos(angle), y + LAMP_SHIFT_M * math.sin(angle), z]
            line = f"{key} = {[round(v, 6) for v in shifted]}"
        if lamp >= 0 and key == "intensity":
            line = f"{key} = {[round(v * LAMP_FACTORS[lamp % 2], 6) for v in json.loads(value)]}"
        out.append(line)
    path = take / "scene_wrong_lamps.toml"
    path.write_text("\n".join(out) + "\n")
    return path
