# SPDX-License-Identifier: Apache-2.0
"""Exposure tools of the page on pictures that are known, and takes that are played."""
from rig import By, by_id, comes_true, field

# The picture that the page would have received: a ramp of grey from left to right, or a step in the middle.
DRAW = """
  const canvas = document.getElementById('canvas'), g = canvas.getContext('2d');
  canvas.width = 512; canvas.height = 64;
  for (let x = 0; x < 512; ++x) {
    const v = arguments[0] === 'ramp' ? Math.floor(x / 2) : x < 256 ? 40 : 200;
    g.fillStyle = `rgb(${v}, ${v}, ${v})`;
    g.fillRect(x, 0, 1, 64);
  }
  Scopes.drawn = ''; Scopes.look();
"""
OVERLAY = """
  const over = document.getElementById('overlay');
  return [...over.getContext('2d').getImageData(0, 32, over.width, 1).data];
"""


def chooses(page, what, value):
    page.execute_script("const e = document.getElementById('scope-' + arguments[0]); e.value = arguments[1];"
                        "e.dispatchEvent(new Event('change'))", what, value)


def overlay(page, kind, picture):
    """RGBA of the middle row, by column."""
    chooses(page, "overlay", kind)
    page.execute_script(DRAW, picture)
    row = page.execute_script(OVERLAY)
    return [row[i:i + 4] for i in range(0, len(row), 4)]


def shows_exposure(page, out):
    # A picture that was sent before the freeze may come after it: none replaces those that are known.
    page.execute_script("window.draws = Picture.drawn; Picture.drawn = () => {}")
    painted = overlay(page, "false", "ramp")
    assert len(painted) == 512
    for value, colour in ((0, [140, 60, 200]), (15, [40, 90, 230]), (60, [60, 60, 60]), (110, [40, 170, 70]),
                          (140, [240, 150, 180]), (250, [245, 225, 60]), (255, [230, 40, 30])):
        assert all(abs(a - b) <= 1 for a, b in zip(painted[2 * value], colour)), (value, painted[2 * value])
    assert "clipped" in by_id(page, "legend").text
    # 3 of 256 values are above 99 %, 6 below 2 %.
    assert by_id(page, "exposure").text == "1.2 % clipped, 2.3 % black", by_id(page, "exposure").text
    striped = [x // 2 for x, pixel in enumerate(overlay(page, "zebra", "ramp")) if pixel[3]]
    assert min(striped) == 243 and len(striped) == 26, (min(striped), len(striped))
    edges = [x for x, pixel in enumerate(overlay(page, "peaking", "step")) if pixel[3]]
    assert edges == [255, 256], edges
    assert not any(pixel[3] for pixel in overlay(page, "peaking", "ramp")), "a ramp is not sharp"
    chooses(page, "overlay", "")
    chooses(page, "guides", "thirds")
    assert by_id(page, "overlay").is_displayed()
    for box in ("waveform", "histogram", "inset"):
        by_id(page, "scope-" + box).click()
    page.execute_script(DRAW, "ramp")
    column = page.execute_script("return [32, 160, 288].map(x => { const d = document.getElementById('waveform')"
                                 ".getContext('2d').getImageData(x, 0, 1, 128).data; let best = 0;"
                                 "for (let y = 0; y < 128; ++y) if (d[4 * y + 1] > d[4 * best + 1] && d[4 * y] < 200) best = y;"
                                 "return best; })")
    for x, y in zip((32, 160, 288), column):  # the ramp is a line from black at the left to white at the right
        assert abs(y - 127 * (1 - x / 320)) <= 4, column
    page.execute_script("Picture.drawn = window.draws")
    comes_true("the matte in the corner", lambda: page.execute_script(
        "return document.getElementById('inset').naturalWidth") > 0)
    if out:
        for kind in ("false", "zebra", "peaking"):
            chooses(page, "overlay", kind)
            comes_true("a picture", lambda: page.execute_script("return Scopes.drawn.endsWith(' ' + Picture.frame)"))
            page.save_screenshot(str(out / f"exposure_{kind}.png"))
    for box in ("waveform", "histogram", "inset"):
        by_id(page, "scope-" + box).click()
    for what in ("overlay", "guides"):
        chooses(page, what, "")
    assert not by_id(page, "overlay").is_displayed() and not by_id(page, "exposure").is_displayed()
    print("exposure tools: false colour, zebra, peaking, guides, waveform, histogram, matte")


def plays_takes(page, rig, out):
    """A finished take is seen in the page, to its end, and at the place that is chosen."""
    take = rig.state()["takes"][0]
    field(page, "play", take["name"]).click()
    shown = lambda: int(page.execute_script("return document.getElementById('player-picture').dataset.frame || 0"))
    comes_true("the first pictures", lambda: shown() >= 2)
    assert page.execute_script("return document.getElementById('player-picture').naturalWidth") == 320
    if out:
        page.save_screenshot(str(out / "player.png"))
    comes_true("the end", lambda: shown() == take["frames"] and by_id(page, "player-play").text == "Play")
    page.execute_script("const e = document.getElementById('player-at'); e.value = 3; e.dispatchEvent(new Event('input'))")
    comes_true("frame 3", lambda: shown() == 3)
    assert f"frame 3 of {take['frames']}" in by_id(page, "player-state").text, by_id(page, "player-state").text
    by_id(page, "player-close").click()
    assert not page.find_element(By.ID, "player").is_displayed()
    print(f"played {take['name']}: {take['frames']} frames")
