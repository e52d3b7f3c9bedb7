#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes docs/results/rules.md: what each rule of the compositor gains. A rule of rules.toml is left
out by other values of constants, or by the scene. With --constants each constant of host/render is
halved and doubled instead, which tells how flat its optimum is.

    docs/results/rules.py                 # builds a program whose constants can be set, 20 min

The product has no such switches: the program is built in a copy of the source, in which each
`constexpr float kName = value;` of host/render reads the environment. Takes are of development
seeds (tests/support/seeds.h). Takes and runs are kept in --cache and used again."""
import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import textwrap
import tomllib
from pathlib import Path

from takes import ROOT

# Name, scenario, depth camera, seed, frames.
TAKES = [("walk", "kinect2", 7, 24), ("talk", "kinect2", 3, 24), ("far", "kinect2", 4, 24),
         ("pan", "kinect2", 8, 20), ("handheld", "kinect2", 7, 20), ("walk", "sr3000", 11, 24)]
SIZE = "640x512"
# Column, path in the report's `error`, digits, +1 where more is better.
MEASURES = [("key_iou", "key_iou", 4, 1), ("hard pixels, key_iou", "contested.key_iou", 4, 1),
            ("matte_mse, 1e-4", "matte_mse", 2, -1), ("flicker", "matte_dtssd", 4, -1),
            ("order wrong, %", "order_wrong_pct", 3, -1),
            ("wrong pieces", "pieces", 2, -1), ("ghosts, px", "scraps.ghost_pixels", 0, -1),
            ("shadow", "light_shadow_rmse", 4, -1), ("object", "object_rmse", 4, -1),
            ("depth, mm", "depth_mae_mm", 2, -1), ("hard pixels, dB", "contested.color_psnr_db", 2, 1)]
# A rule that gains less than the first in the mean and less than the second on every take pays for
# nothing.
LITTLE = {"key_iou": (0.002, 0.01), "hard pixels, key_iou": (0.002, 0.01), "flicker": (0.002, 0.01),
          "order wrong, %": (0.05, 0.2), "wrong pieces": (0.1, 0.5), "ghosts, px": (30, 150),
          "shadow": (0.002, 0.01), "object": (0.002, 0.01), "depth, mm": (1, 5),
          "hard pixels, dB": (0.1, 0.3)}
CONSTANT = re.compile(r"^( *)(inline )?(static )?constexpr (float|double|int) (k[A-Z]\w*) *= *"
                      r"([^;]+);", re.M)
HEADER = """// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>
#include <cstring>
/// The value of a constant: that of MIXRIG_RULES ("kName=1,kOther=2"), else its own.
template <typename T>
T rule_value(const char* name, T value) {
  const char* at = std::getenv("MIXRIG_RULES");
  const std::size_t length = std::strlen(name);
  while (at != nullptr && *at != 0) {
    if (std::strncmp(at, name, length) == 0 && at[length] == '=')
      return static_cast<T>(std::atof(at + length + 1));
    at = std::strchr(at, ',');
    if (at != nullptr) ++at;
  }
  return value;
}
"""


def constants(path):
    """(type, name, value) of a file's constants that can be set."""
    return [(m[4], m[5], m[6]) for m in CONSTANT.finditer(path.read_text()) if ", k" not in m[6]]


def sources(tree):
    return sorted(p for p in (tree / "host/render").rglob("*") if p.suffix in (".h", ".cpp"))


def loosen(tree, fixed):
    """Lets the constants of host/render in `tree` be set, but those in `fixed`."""
    header = tree / "rule_value.h"
    header.write_text(HEADER)
    for path in sources(tree):
        def loose(m):
            indent, inline, static, kind, name, value = m.groups()
            if name in fixed or re.search(r", *k[A-Z]", value):
                return m.group(0)
            place = "inline " if inline else "static " if indent or static else ""
            return (f'{indent}{place}const {kind} {name} = '
                    f'::rule_value<{kind}>("{name}", static_cast<{kind}>({value}));')
        text = path.read_text()
        changed = CONSTANT.sub(loose, text)
        if changed != text:
            path.write_text(f'#include "{header}"\n' + changed)


def build(cache):
    """A program whose constants can be set. Constants that size arrays stay: the compiler names
    them."""
    tree, fixed = cache / "tree", set()
    for _ in range(8):
        shutil.rmtree(tree / "host/render", ignore_errors=True)
        archive = subprocess.run(["git", "-C", ROOT, "archive", "HEAD"], capture_output=True,
                                 check=True)
        tree.mkdir(parents=True, exist_ok=True)
        subprocess.run(["tar", "-x", "-C", tree], input=archive.stdout, check=True)
        loosen(tree, fixed)
        subprocess.run(["cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja",
                        "-DCMAKE_BUILD_TYPE=Release", "-DMIXRIG_TESTS=OFF", "-DMIXRIG_MARCH=native",
                        "-DCMAKE_CXX_FLAGS=-Wno-error -Wno-sign-compare"], check=True)
        made = subprocess.run(["cmake", "--build", tree / "build", "--target", "mixrig", "--",
                               "-k", "0"], capture_output=True, text=True)
        if made.returncode == 0:
            return tree / "build/host/tools/mixrig"
        errors = re.findall(r"error: .*\n.*", made.stdout)
        more = {n for e in errors for n in re.findall(r"\bk[A-Z]\w*", e)} - fixed
        if not more:
            raise SystemExit(made.stdout[-4000:])
        fixed |= more
    raise SystemExit("rules.py: the program does not build")


def scene_with(take, changes):
    """The take's scene, with keys of tables set."""
    scene = take / "scene.toml"
    if not changes:
        return scene
    table, out = "", []
    for line in scene.read_text().splitlines():
        if line.startswith("["):
            table = line.strip("[]")
        if line.partition(" = ")[0] not in changes.get(table, {}):
            out.append(line)
    for name, keys in changes.items():
        lines = [f"{k} = {json.dumps(v)}" for k, v in keys.items()]
        if f"[{name}]" not in out:
            out += ["", f"[{name}]"]
        at = out.index(f"[{name}]") + 1
        out[at:at] = lines
    text = "\n".join(out) + "\n"
    path = take / ("scene_" + hashlib.sha256(text.encode()).hexdigest()[:8] + ".toml")
    path.write_text(text)
    return path


class Runs:
    def __init__(self, mixrig, studio, cache):
        self.mixrig, self.studio, self.takes = Path(mixrig), Path(studio), cache / "takes"
        self.runs = cache / ("runs-" + hashlib.sha256(self.mixrig.read_bytes()).hexdigest()[:12])
        self.runs.mkdir(parents=True, exist_ok=True)

    def take(self, scenario, rig, seed, frames):
        out = self.takes / f"{scenario}-{rig}-{seed}"
        if not (out / "take.toml").exists():
            subprocess.run([self.studio, "studio", out, "--scenario", scenario, "--rig", rig,
                            "--seed", str(seed), "--frames", str(frames), "--size", SIZE],
                           check=True, stdout=subprocess.DEVNULL)
        return out

    def errors(self, take, off, scene):
        """The report's `error` of a take, with constants `off` and keys of the scene changed."""
        setting = ",".join(f"{k}={v}" for k, v in sorted(off.items()))
        tag = hashlib.sha256((setting + json.dumps(scene)).encode()).hexdigest()[:12]
        report = self.runs / f"{take.name}-{tag}.json"
        if not report.exists():
            made = subprocess.run(
                [self.mixrig, "run", scene_with(take, scene), "--source", f"take:{take}", "--backend",
                 "cpu", "--threads", "1", "--json", report],
                env={**os.environ, "MIXRIG_RULES": setting}, capture_output=True, text=True)
            if made.returncode:
                raise SystemExit(made.stderr)
        return json.loads(report.read_text())["error"]

    def row(self, off, scene):
        """Mean and per take: each measure."""
        takes = [self.errors(self.take(*t), off, scene) for t in TAKES]
        return [[value(e, path) for e in takes] for _, path, _, _ in MEASURES]


def value(error, path):
    if path == "pieces":
        scraps = error.get("scraps", {})
        return sum(scraps.get(k, 0) for k in ("object_through_person", "person_through_object",
                                              "room_through", "over_room"))
    for key in path.split("."):
        error = (error or {}).get(key)
    return error * 1e4 if path == "matte_mse" and error is not None else error


def mean(values):
    known = [v for v in values if v is not None]
    return sum(known) / len(known) if known else None


def gains(base, other):
    """For each measure: mean gain of the rule, and the take that gains most or loses most."""
    out = []
    for (_, _, _, sign), with_rule, without in zip(MEASURES, base, other):
        each = [sign * (a - b) for a, b in zip(with_rule, without)
                if a is not None and b is not None]
        out.append((mean(each), max(each, key=abs)) if each else (None, None))
    return out


def gains_little(row):
    for (mean_gain, most), (name, *_) in zip(row, MEASURES):
        if name in LITTLE and mean_gain is not None:
            if mean_gain >= LITTLE[name][0] or most >= LITTLE[name][1]:
                return False
    return True


def cells(row):
    out = []
    for (mean_gain, most), (_, _, digits, _) in zip(row, MEASURES):
        out.append("-" if mean_gain is None else
                   "0" if most == 0 else f"{mean_gain:+.{digits}f} ({most:+.{digits}f})")
    return out


def table(base, rows):
    heads = ["rule", "of"] + [m[0] for m in MEASURES]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    absolute = [f"{mean(v):.{m[2]}f}" for v, m in zip(base, MEASURES)]
    lines.append("| | **all rules, mean** | " + " | ".join(absolute) + " |")
    for name, of, other in rows:
        lines.append("| " + " | ".join([name, of, *cells(gains(base, other))]) + " |")
    return "\n".join(lines)


def wrapped(line):
    return line if line.startswith(("|", "#", "<")) else textwrap.fill(line, 120)


PAGE = """<!-- Made by docs/results/rules.py -->
# What each rule gains
Each rule of the [compositor](../method/compositor.md) was left out alone. A cell is the mean gain of the rule over the
takes, better is positive, and in brackets the gain on the take where it is largest in size. `0`: the rule changes
nothing. `matte_mse` is in 1e-4. Constants that leave a rule out stand in [rules.toml](rules.toml).

*Takes of development seeds, judged look, {size}: {takes}. Half of their frames are empty. cpu back end.*

{table}

## Rules that gain little
On these takes these rules gain little in every measure: {idle}.

Little is less, in the mean and on every take, than: {little}.

Other takes may need them: a rule is taken out only after recordings, and takes at full size, agree.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--mixrig", help="a program whose constants can be set; else it is built")
    parser.add_argument("--studio", default=ROOT / "build/release/host/tools/mixrig")
    parser.add_argument("--cache", type=Path, default=ROOT / "out/rules")
    parser.add_argument("--constants", action="store_true", help="print each constant's slope instead")
    parser.add_argument("--out", type=Path, default=ROOT / "docs/results/rules.md")
    asked = parser.parse_args()
    cache = asked.cache.resolve()
    runs = Runs(asked.mixrig or build(cache), asked.studio, cache)
    base = runs.row({}, {})
    rows = []
    if asked.constants:
        for path in sources(ROOT):
            for kind, name, text in constants(path):
                number = re.fullmatch(r"-?[\d.]+(e-?\d+)?F?", text)
                if not number or float(text.rstrip("F")) == 0:
                    continue
                for factor in (0.5, 2):
                    setting = float(text.rstrip("F")) * factor
                    setting = round(setting) if kind == "int" else setting
                    rows.append((f"{name} {setting:g}", path.stem, runs.row({name: setting}, {})))
        print(table(base, rows))
        return
    for rule in tomllib.loads((ROOT / "docs/results/rules.toml").read_text())["rule"]:
        rows.append((rule["name"], rule["of"], runs.row(rule.get("off", {}), rule.get("scene", {}))))
    takes = ", ".join(f"{s} {seed} ({rig})" for s, rig, seed, _ in TAKES)
    idle = "; ".join(name for name, _, other in rows if gains_little(gains(base, other)))
    little = "; ".join(f"{k.removesuffix(', %').removesuffix(', px')} {a:g} and {b:g}" for k, (a, b) in LITTLE.items())
    text = PAGE.format(size=SIZE, takes=takes, table=table(base, rows), idle=idle, little=little)
    asked.out.write_text("\n".join(wrapped(line) for line in text.split("\n")))


if __name__ == "__main__":
    main()
