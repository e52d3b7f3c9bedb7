# SPDX-License-Identifier: Apache-2.0
"""Plots of values over categories, as SVG."""
import math
from dataclasses import dataclass


@dataclass
class Series:
    name: str
    values: list  # one a category, None where there is none
    color: str
    filled: bool = True


WIDTH, HEIGHT = 860, 360
LEFT, RIGHT, TOP, BOTTOM = 60, 175, 40, 40


def step_of(largest):
    """1, 2 or 5 times a power of ten, so that at most eight steps cover 0..largest."""
    power = 10 ** math.floor(math.log10(largest / 8))
    return next(f * power for f in (1, 2, 5, 10) if f * power * 8 >= largest)


def text(x, y, words, anchor="start", extra=""):
    return f"<text x='{x:.0f}' y='{y:.0f}' text-anchor='{anchor}'{extra}>{words}</text>"


def dot(x, y, series):
    fill = series.color if series.filled else "white"
    return (f"<circle cx='{x:.1f}' cy='{y:.1f}' r='4.5' fill='{fill}' stroke='{series.color}' "
            "stroke-width='1.5'/>")


def plot(title, y_label, categories, series):
    """Axis from zero. Dots of one category stand side by side in the order of the series."""
    largest = max(v for s in series for v in s.values if v is not None) or 1
    step = step_of(largest)
    top = step * math.ceil(largest / step)
    inner_w, inner_h = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM
    slot = inner_w / len(categories)
    y_of = lambda v: TOP + inner_h * (1 - v / top)
    out = [f"<svg xmlns='http://www.w3.org/2000/svg' width='{WIDTH}' height='{HEIGHT}' "
           "font-family='sans-serif' font-size='12'>",
           "<rect width='100%' height='100%' fill='white'/>",
           text(LEFT, 22, title, extra=" font-size='14'"),
           text(16, TOP + inner_h / 2, y_label, "middle",
                f" transform='rotate(-90 16 {TOP + inner_h / 2:.0f})'")]
    for i in range(round(top / step) + 1):
        y = y_of(i * step)
        out.append(f"<line x1='{LEFT}' x2='{WIDTH - RIGHT}' y1='{y:.1f}' y2='{y:.1f}' "
                   "stroke='#ddd'/>")
        out.append(text(LEFT - 6, y + 4, f"{i * step:g}", "end"))
    for i, category in enumerate(categories):
        out.append(text(LEFT + slot * (i + 0.5), HEIGHT - BOTTOM + 18, category, "middle"))
        for k, s in enumerate(series):
            if s.values[i] is not None:
                x = LEFT + slot * (i + 0.15 + 0.7 * (k + 0.5) / len(series))
                out.append(dot(x, y_of(s.values[i]), s))
    for k, s in enumerate(series):
        y = TOP + 10 + 20 * k
        out.append(dot(WIDTH - RIGHT + 18, y, s))
        out.append(text(WIDTH - RIGHT + 30, y + 4, s.name))
    return "\n".join(out + ["</svg>", ""])
