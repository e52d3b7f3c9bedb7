# SPDX-License-Identifier: Apache-2.0
"""The page of figures, from the reports of the runs."""
import textwrap
from statistics import mean

from inputs import caption
from svg import Series, plot
from takes import (BOARD_VIEWS, FRAMES, FULL_FRAMES, FULL_SIZE, MOVING, RIGS, ROOT, SIZE, STILL)

SCENARIOS = STILL + MOVING
COLORS = {"kinect2": "#0b61a4", "sr3000": "#c23b22", "helios2": "#2e8b57"}
COMPOSITES = {"plate": "#999999", "pasted": "#d9a441", "depth_key": "#c23b22", "mixrig": "#0b61a4",
              "ideal": "#2e8b57"}
# What the tests hold kinect2, sr3000 and helios2 to (tests/e2e).
BOUNDS = {"key_iou": {"kinect2": 0.95, "sr3000": 0.90, "helios2": 0.95},
          "order_wrong_pct": 2.0, "light_shadow_rmse": 0.06, "depth_bad_pct": 6.0}
MOVING_KEY_IOU = 0.92
WORST = {"key": "contested.key_iou", "order": "order_wrong_pct", "shadow": "light_shadow_rmse",
         "object": "object_rmse"}
GROUPS = {"camera still": STILL, "camera moves": MOVING}
SHOWN = ["walk", "pan"]  # scenarios of the tables that compare two conditions

TEXT = """<!-- Made by docs/results/make.py: change docs/results/page.py. -->
# Figures of the virtual studio
Takes of the virtual studio, composited by mixrig and judged against ground truth. Three plain composites of the same
frames stand beside it: the **plate** as it is, the objects **pasted** on top, and a **depth key** without colour.
**ideal** is a compositor without error on these plates.

- [Measures](../reference/measures.md) defines every column: key_iou is `key_iou`, order `order_wrong_pct`, shadow
  `light_shadow_rmse`, object `object_rmse`, PSNR `color_psnr_db`. Columns of hard pixels are of `error.contested`.
- Figures are means over takes on which nothing was tuned (`tests/support/seeds.h`).
- The *judged* look of the studio is its realistic one, the *plain* look has noise only
  ([studio](../reference/studio.md)).

<!-- CONDITIONS -->

![wrongly keyed hard pixels by scenario](key.svg)
![colour of hard pixels by scenario](composites.svg)
![error of shadows by scenario](shadow.svg)
![time of a frame by scenario](cost.svg)

## Scenarios
<!-- SCENARIOS -->

## Depth cameras
<!-- RIGS -->

## Looks
Cells: plain look (`--plain`) / judged look.

<!-- LOOKS -->

## Calibration
Cells: true / estimated from boards that the same cameras see.

<!-- CALIBRATION -->

## Lamps
Cells: true lamps / every lamp 0.3 m aside, in turn to the four diagonals, and by turns 30 % too bright and too dark.

<!-- LAMPS -->

## Full size
<!-- SPEED -->

## Where it is bad
Takes beyond the bounds of the tests, which hold the plain look, and takes on which a plain composite is nearly as
good. [Reasons](faults.md) says what was found in the frames.

<!-- BOUNDS -->

Each picture shows the worst frame of the worst take.

<!-- PICTURES -->"""


def get(report, path):
    """"error.contested.key_iou" of a report, or None."""
    for key in path.split("."):
        report = report.get(key) if report is not None else None
    return report


def average(values):
    known = [v for v in values if v is not None]
    return mean(known) if known else None


def cell(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def wrapped(words, indent=""):
    """Lines of at most 120 characters."""
    return textwrap.fill(words, 120, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False) + "\n"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


# Title, digits, and the measure of mixrig and of what it is held against.
COLUMNS = [
    ("ms a frame", 1, ["frame_ms.p50"]),
    ("key_iou", 3, ["error.key_iou"]),
    ("hard pixels, key_iou: depth key, mixrig", 3,
     ["baselines.depth_key.contested.key_iou", "error.contested.key_iou"]),
    ("order wrong, %: pasted, depth key, mixrig", 2,
     ["baselines.pasted.order_wrong_pct", "baselines.depth_key.order_wrong_pct",
      "error.order_wrong_pct"]),
    ("shadow: none, mixrig", 3,
     ["baselines.pasted.light_shadow_rmse", "error.light_shadow_rmse"]),
    ("object", 3, ["error.object_rmse"]),
    ("hard pixels, PSNR, dB: plate, pasted, depth key, mixrig, ideal", 1,
     ["baselines.plate.contested.color_psnr_db", "baselines.pasted.contested.color_psnr_db",
      "baselines.depth_key.contested.color_psnr_db", "error.contested.color_psnr_db",
      "baselines.ideal.contested.color_psnr_db"]),
    ("PSNR, dB", 1, ["error.color_psnr_db"]),
]


def columns_of(reports):
    return [" / ".join(cell(average(get(r, path) for r in reports), digits) for path in paths)
            for _, digits, paths in COLUMNS]


class Page:
    def __init__(self, runs, chosen, calibrated, pictures, machine):
        self.runs, self.chosen, self.calibrated = runs, chosen, calibrated
        self.pictures, self.machine = pictures, machine

    def of(self, kind, scenarios, rigs):
        return [r for (k, s, rig, _), r in self.runs.items()
                if k == kind and s in scenarios and rig in rigs]

    def measure(self, kind, scenario, rigs, path):
        return average(get(r, path) for r in self.of(kind, [scenario], rigs))

    def inputs(self, *kinds):
        """What the runs of these kinds knew: "true: poses, ...; wrong: lamps"."""
        return caption([r for kind in kinds for r in self.of(kind, SCENARIOS, RIGS)])

    def conditions(self):
        return wrapped(
            f"*Unless stated: seeds {', '.join(map(str, self.chosen))}, judged look, "
            f"{self.inputs('true', 'plain', 'full')}; {SIZE}, {FRAMES[STILL[0]] // 2} judged frames (moving "
            f"camera: {FRAMES[MOVING[0]] // 2}) of each take after as many empty ones; "
            f"{self.machine}. `mixrig studio TAKE --scenario S --rig R --seed N --frames "
            f"{FRAMES[STILL[0]]} --size {SIZE}` (moving: {FRAMES[MOVING[0]]}), `mixrig run "
            "TAKE/scene.toml --source take:TAKE --backend cpu --baselines`.*") + "\n"

    def group_rows(self, rig):
        return [[f"**{name}**"] + columns_of(self.of("true", group, [rig]))
                for name, group in GROUPS.items()]

    def scenario_section(self):
        rows = [[s] + columns_of(self.of("true", [s], RIGS[:1])) for s in SCENARIOS]
        return f"Depth camera: {RIGS[0]}.\n\n" + table(
            ["scenario"] + [c[0] for c in COLUMNS], rows + self.group_rows(RIGS[0])) + "\n"

    def rig_section(self):
        rows = [[rig] + row for rig in RIGS[1:] for row in self.group_rows(rig)]
        return "Means over the scenarios.\n\n" + table(
            ["depth camera", "scenarios"] + [c[0] for c in COLUMNS], rows) + "\n"

    def condition_table(self, kinds, paths, rigs=RIGS):
        """A row a scenario and depth camera, each cell: under the one / under the other."""
        rows = []
        for scenario in SHOWN:
            for rig in rigs:
                rows.append([scenario, rig] + [
                    " / ".join(cell(self.measure(kind, scenario, [rig], path), digits)
                               for kind in kinds) for _, digits, path in paths])
        return table(["scenario", "depth camera"] + [p[0] for p in paths], rows) + "\n"

    def calibration_section(self):
        paths = [("ms a frame", 1, "frame_ms.p50"), ("`depth_mae_mm`", 1, "error.depth_mae_mm"),
                 ("key_iou", 4, "error.key_iou"),
                 ("hard pixels, key_iou", 4, "error.contested.key_iou"),
                 ("order wrong, %", 2, "error.order_wrong_pct"),
                 ("shadow", 4, "error.light_shadow_rmse"),
                 ("hard pixels, PSNR, dB", 2, "error.contested.color_psnr_db")]
        return wrapped(
            f"*Seed {', '.join(map(str, self.calibrated))}, `--tolerance 1`; `mixrig studio BOARDS "
            f"--scenario board --views {BOARD_VIEWS} --tolerance 1 --size {SIZE}`, `mixrig "
            "calibrate rig BOARDS`, which refuses boards that few views show (-). First: "
            f"{self.inputs('known')}. Second: {self.inputs('estimated')}.*") + "\n" + \
            self.condition_table(["known", "estimated"], paths)

    def look_section(self):
        paths = [("key_iou", 3, "error.key_iou"),
                 ("hard pixels, key_iou", 3, "error.contested.key_iou"),
                 ("order wrong, %", 2, "error.order_wrong_pct"),
                 ("shadow", 3, "error.light_shadow_rmse"),
                 ("object", 3, "error.object_rmse"),
                 ("`depth_mae_mm`", 0, "error.depth_mae_mm"),
                 ("PSNR, dB", 1, "error.color_psnr_db")]
        return self.condition_table(["plain", "true"], paths)

    def lamp_section(self):
        paths = [("shadow", 3, "error.light_shadow_rmse"),
                 ("object", 3, "error.object_rmse"),
                 ("hard pixels, PSNR, dB", 1, "error.contested.color_psnr_db"),
                 ("PSNR, dB", 1, "error.color_psnr_db")]
        return wrapped(f"*Second: {self.inputs('off')}.*") + "\n" + self.condition_table(["true", "off"], paths, RIGS[:1])

    def speed_section(self):
        rows = []
        for (kind, scenario, rig, seed), r in self.runs.items():
            if kind == "full":
                rows.append([f"{scenario} {seed}", rig, cell(r["fps"], 1),
                             f"{cell(r['frame_ms']['p50'], 1)} / {cell(r['frame_ms']['p95'], 1)}",
                             cell(r["rss_mb"], 0)] + columns_of([r])[1:2] +
                            [cell(get(r, p), d) for d, p in
                             ((3, "error.contested.key_iou"), (2, "error.order_wrong_pct"),
                              (3, "error.light_shadow_rmse"), (3, "error.object_rmse"),
                              (1, "error.contested.color_psnr_db"))])
        return wrapped(f"*{FULL_SIZE}, seed {self.chosen[0]}, {FULL_FRAMES // 2} judged frames.*") + "\n" + table(
            ["take", "depth camera", "frames a second", "frame p50 / p95, ms", "memory, MB", "key_iou",
             "hard pixels, key_iou", "order wrong, %", "shadow", "object", "hard pixels, PSNR, dB"], rows) + "\n"

    def broken_bounds(self):
        lines = []
        for (kind, scenario, rig, seed), r in self.runs.items():
            if kind != "true":
                continue
            least = MOVING_KEY_IOU if scenario in MOVING else 0
            bounds = dict(BOUNDS, key_iou=min(BOUNDS["key_iou"][rig], least or 1))
            for key, bound in bounds.items():
                value = get(r, "error." + key)
                if value is not None and (value < bound if key == "key_iou" else value > bound):
                    lines.append((f"`{key}`", abs(value - bound),
                                  f"{scenario} {seed}, {rig}: {value:.4g} (bound {bound:g})"))
            order, pasted = (get(r, p + ".order_wrong_pct") for p in ("error", "baselines.pasted"))
            if order > 0.9 * pasted:
                lines.append(("`order_wrong_pct` no better than of the objects pasted on top",
                              order - 0.9 * pasted,
                              f"{scenario} {seed}, {rig}: {order:.3g} against {pasted:.3g}"))
            best = max(v for v in (get(r, f"baselines.{b}.contested.color_psnr_db")
                                   for b in ("plate", "pasted", "depth_key")) if v is not None)
            own = get(r, "error.contested.color_psnr_db")
            if own < best + 1:
                lines.append(("PSNR of hard pixels less than 1 dB above the best plain composite",
                              best + 1 - own,
                              f"{scenario} {seed}, {rig}: {own:.1f} against {best:.1f} dB"))
        out = ""
        for key in dict.fromkeys(k for k, _, _ in lines):
            mine = sorted(((by, words) for k, by, words in lines if k == key), reverse=True)
            out += wrapped(
                f"- {key}, {len(mine)} of {len(self.of('true', SCENARIOS, RIGS))} takes, "
                f"farthest beyond: {'; '.join(words for _, words in mine[:3])}.", "  ")
        return out or "Every take is within the bounds of the tests.\n"

    def picture_section(self):
        out = ""
        for name, scenario, rig, seed, number in self.pictures:
            out += (f"Worst `{WORST[name]}`: {scenario} {seed}, {rig}, frame {number}.\n\n"
                    f"![{scenario} {seed}, {rig}, frame {number}](worst_{name}.png)\n\n")
        return out.rstrip("\n") + "\n"

    def plots(self):
        per = lambda kind, rigs, path: [self.measure(kind, s, rigs, path) for s in SCENARIOS]
        wrong = lambda values: [None if v is None else 100 * (1 - v) for v in values]
        key = []
        for rig, color in COLORS.items():
            for name, path, filled in (("depth key", "baselines.depth_key", False),
                                       ("mixrig", "error", True)):
                key.append(Series(f"{name}, {rig}",
                                  wrong(per("true", [rig], path + ".contested.key_iou")), color,
                                  filled))
        composites = [Series(name, per("true", RIGS, ("error" if name == "mixrig" else
                                                      f"baselines.{name}") +
                                       ".contested.color_psnr_db"), color)
                      for name, color in COMPOSITES.items()]
        shadow = [Series("no shadow", per("true", RIGS, "baselines.pasted.light_shadow_rmse"),
                         "#999999", False),
                  Series("wrong lamps", per("off", RIGS, "error.light_shadow_rmse"), "#d9a441"),
                  Series("true lamps", per("true", RIGS, "error.light_shadow_rmse"), "#0b61a4")]
        cost = [Series(rig, per("true", [rig], "frame_ms.p50"), color)
                for rig, color in COLORS.items()]
        return {
            "key.svg": plot("Wrongly keyed hard pixels", "% (100 (1 - key_iou))", SCENARIOS,
                            key),
            "composites.svg": plot("Colour of hard pixels", "PSNR, dB", SCENARIOS, composites),
            "shadow.svg": plot("Shadows", "light_shadow_rmse", SCENARIOS, shadow),
            "cost.svg": plot(f"Time of a frame at {SIZE}: camera still, and moving (the last "
                             f"{len(MOVING)})", "ms, median", SCENARIOS, cost),
        }

    def write(self, out):
        for name, drawing in self.plots().items():
            (out / name).write_text(drawing)
        text = TEXT
        for mark, words in {
                "CONDITIONS": self.conditions(), "SCENARIOS": self.scenario_section(),
                "RIGS": self.rig_section(), "CALIBRATION": self.calibration_section(),
                "LOOKS": self.look_section(), "LAMPS": self.lamp_section(),
                "SPEED": self.speed_section(), "BOUNDS": self.broken_bounds(),
                "PICTURES": self.picture_section()}.items():
            text = text.replace(f"<!-- {mark} -->", words.rstrip("\n"))
        (out / "figures.md").write_text(text + "\n")
