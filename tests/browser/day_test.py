#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A day on set with the operator's page: undo, objects, presets, slate, lock, and a rig that dies.

usage: day_test.py MIXRIG [FOLDER]   screenshots go to FOLDER
Exit status 77: skipped, Chromium or selenium is not there.
"""
import os
import pathlib
import struct
import sys
import tempfile
import tomllib

from rig import (ActionChains, By, Keys, Rig, age_ms, browser, by_id, comes_true, field, finds_nothing_serious,
                 has_names, presses, skip_without_browser, types)
from exposure import plays_takes, shows_exposure
from language import speaks_german
from picture import shows_a_live_picture

SIZES = {"desktop": (1440, 900), "portrait": (390, 844), "landscape": (844, 390)}


def is_resized(page, width, height):
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 1000 or height < 500})
    page.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": width < 1000})


def slides(page, slider, value):
    """One pull at a slider, to this value."""
    page.execute_script("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('change'))", slider, value)


def handle(page, name):
    return comes_true(f"the mark of {name}", lambda: page.find_elements(By.CSS_SELECTOR, f'[aria-label="Move {name}"]'))[0]


def undoes_each_edit(page, rig):
    """Each edit is taken back by Ctrl+Z to the byte, and made again by Ctrl+Shift+Z."""
    name = rig.scene()["object"][0]["name"]
    lamp = rig.scene()["light"]["lamp"][0]["name"]
    drag = lambda: ActionChains(page).click_and_hold(handle(page, name)).move_by_offset(-20, -8).move_by_offset(
        -20, -8).release().perform()
    edits = {
        "move " + name: drag,
        "turn " + name: lambda: slides(page, field(page, "turn", name), 40),
        "scale " + name: lambda: types(field(page, "scale", name), "1.5"),
        "hide " + name: lambda: field(page, "hide", name).click(),
        "remove " + name: lambda: field(page, "remove", name).click(),
        "dim " + lamp: lambda: slides(page, field(page, "strength", lamp), -0.5),
        "switch off " + lamp: lambda: field(page, "on", lamp).click(),
        "depth of field": lambda: by_id(page, "focus-on").click(),
    }
    for what, edit in edits.items():
        before = rig.scene_file.read_text()
        edit()
        comes_true(what, lambda: rig.scene_file.read_text() != before and rig.state()["edits"]["undo"] == what)
        comes_true("the button", lambda: by_id(page, "undo").get_attribute("title") == f"Undo: {what}")
        after = rig.scene_file.read_text()
        presses(page, Keys.CONTROL, "z")
        comes_true(f"undo of: {what}", lambda: rig.scene_file.read_text() == before)
        comes_true("redo is possible", lambda: by_id(page, "redo").is_enabled())
        presses(page, Keys.CONTROL, Keys.SHIFT, "z")
        comes_true(f"redo of: {what}", lambda: rig.scene_file.read_text() == after)
        comes_true("undo is possible", lambda: by_id(page, "undo").is_enabled())
        by_id(page, "undo").click()
        comes_true(f"undo by the button: {what}", lambda: rig.scene_file.read_text() == before)
        comes_true("the run knows", lambda: len(rig.state()["objects"]) == len(rig.scene()["object"]) and
                   not rig.state()["focus"]["on"])
    print(f"undone and made again: {', '.join(edits)}")


def escape_cancels(page, rig):
    """A drag of a mark: neither the file nor the run keeps it."""
    thing = comes_true("an object", lambda: next(o for o in rig.state()["objects"] if o["at"]))
    before = rig.scene_file.read_text()
    chain = ActionChains(page).click_and_hold(handle(page, thing["name"])).move_by_offset(-30, -10)
    chain.move_by_offset(-30, -10).perform()
    position = lambda: next(o for o in rig.state()["objects"] if o["name"] == thing["name"])["position_m"]
    comes_true("the preview", lambda: position() != thing["position_m"])
    ActionChains(page).send_keys(Keys.ESCAPE).perform()
    comes_true("where it was", lambda: position() == thing["position_m"])
    ActionChains(page).move_by_offset(-10, 0).release().perform()
    comes_true("the word", lambda: "Cancelled" in by_id(page, "message").text)
    assert rig.scene_file.read_text() == before and position() == thing["position_m"]


def box_of(side):
    """A cube that stands on its origin, as .glb."""
    half = side / 2
    corners = [(x, y, z) for x in (-half, half) for y in (0, side) for z in (-half, half)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    indices = [i for a, b, c, d in faces for i in (a, b, c, a, c, d)]
    data = b"".join(struct.pack("<3f", *c) for c in corners) + struct.pack(f"<{len(indices)}H", *indices)
    text = ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":'
            '[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":%d}],"bufferViews":[{"buffer":0,'
            '"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],"accessors":[{"bufferView":0,'
            '"componentType":5126,"count":8,"type":"VEC3","min":[%g,0,%g],"max":[%g,%g,%g]},{"bufferView":1,'
            '"componentType":5123,"count":36,"type":"SCALAR"}]}' % (len(data), -half, -half, half, side, half)).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) + struct.pack("<I4s", len(text), b"JSON") + text +
            struct.pack("<I4s", len(data), b"BIN\0") + data)


def adds_models(page, rig):
    """One in millimetres is fitted to the room, in sight; what is no model is said in plain words; renamed, copied."""
    model = rig.folder / "cube.glb"
    model.write_bytes(box_of(1800))
    by_id(page, "upload").send_keys(str(model))
    cube = comes_true("the cube", lambda: next(o for o in rig.state()["objects"] if o["name"] == "cube" and o["at"]))
    assert 0.1 < 1800 * cube["scale"] < 3 and 0.3 < cube["at"][0] < 0.7, cube
    print(f"a cube of 1800 m: scale {cube['scale']}, {1800 * cube['scale']:.2f} m, at {cube['at']}")
    bad = rig.folder / "bad.glb"
    bad.write_text("no model")
    by_id(page, "upload").send_keys(str(bad))
    comes_true("plain words", lambda: by_id(page, "message-text").text == 'the model "bad" is no glTF file: use .gltf or .glb')
    by_id(page, "message-close").click()
    types(field(page, "name", "cube"), "box")
    comes_true("the new name", lambda: rig.object("box"))
    field(page, "duplicate", "box").click()
    comes_true("the copy", lambda: rig.object("box 2"))
    comes_true("the run knows", lambda: any(o["name"] == "box 2" for o in rig.state()["objects"]))
    for _ in range(3):
        presses(page, Keys.CONTROL, "z")
        comes_true("one step back", lambda: "Undone" in by_id(page, "message").text)
        presses(page, "m")
    assert not any(o["name"] in ("box", "box 2", "cube") for o in rig.scene()["object"])


def has_presets(page, rig):
    lamp = rig.scene()["light"]["lamp"][0]
    by_id(page, "preset-name").send_keys("day")
    by_id(page, "preset-store").click()
    comes_true("the file", lambda: (rig.scene_file.parent / "presets/day.toml").exists())
    comes_true("as it is shown", lambda: "as it is shown" in by_id(page, "presets").text)
    before = rig.scene_file.read_text()
    field(page, "on", lamp["name"]).click()
    comes_true("the difference", lambda: "1 difference" in by_id(page, "presets").text)
    page.find_element(By.CSS_SELECTOR, "#presets summary").click()
    comes_true("which one", lambda: f"{lamp['name']}: " in by_id(page, "presets").text)
    field(page, "recall", "day").click()
    comes_true("the scene as it was stored", lambda: rig.scene()["light"] == tomllib.loads(before)["light"])
    comes_true("as it is shown again", lambda: "as it is shown" in by_id(page, "presets").text)
    comes_true("that can be undone", lambda: by_id(page, "undo").get_attribute("title") == "Undo: preset day")


def keeps_the_slate(page, rig):
    """Takes are counted, circled and noted; a name that exists is counted on."""
    by_id(page, "slate-scene").send_keys("12A")
    by_id(page, "slate-shot").send_keys("3")
    for number in (1, 2):
        comes_true("the count", lambda: by_id(page, "take-name").get_attribute("placeholder") == f"12A-3 take {number}")
        presses(page, "r")
        comes_true("frames", lambda: rig.state()["recording"]["on"] and rig.state()["recording"]["seconds"] >= 3)
        assert rig.state()["recording"]["name"] == f"12A-3 take {number}"
        presses(page, "r")
        comes_true("the end", lambda: len(rig.state()["takes"]) == number and not rig.state()["recording"]["on"])
    take = rig.state()["takes"][-1]
    assert take["name"] == "12A-3 take 2" and take["state"] == "whole" and take["seconds"] >= 2.5 and take["megabytes"] > 0, take
    field(page, "circle", "12A-3 take 1").click()
    types(field(page, "notes", "12A-3 take 1"), "wind")
    note = rig.folder / "recordings/12A-3 take 1/recording.toml"
    comes_true("the circle", lambda: tomllib.loads(note.read_text()) | {"circled": True, "notes": "wind"} ==
               tomllib.loads(note.read_text()))
    comes_true("minutes", lambda: "of recording" in by_id(page, "disk-left").text)
    by_id(page, "take-name").send_keys("12A-3 take 1")
    by_id(page, "record").click()
    comes_true("the proposal", lambda: by_id(page, "take-name").get_attribute("value") == "12A-3 take 3")
    assert "exists" in by_id(page, "message").text and not rig.state()["recording"]["on"]
    print(f"takes: {[(t['name'], t['seconds'], t['megabytes'], t['circled']) for t in rig.state()['takes']]}, "
          f"{by_id(page, 'disk-left').text}")


def locks(page, rig):
    before = rig.scene_file.read_text()
    presses(page, "l")
    comes_true("the lock", lambda: page.execute_script("return document.querySelector('#objects').closest('section').inert"))
    presses(page, Keys.CONTROL, "z")
    assert by_id(page, "record").is_enabled() and not by_id(page, "undo").is_enabled()
    presses(page, "l")
    comes_true("no lock", lambda: by_id(page, "undo").is_enabled())
    assert rig.scene_file.read_text() == before
    presses(page, "?")
    comes_true("the keys", lambda: by_id(page, "help").is_displayed() and "Undo" in by_id(page, "help").text)
    by_id(page, "help-close").click()
    for key, view in (("6", "matte"), ("0", "program")):
        presses(page, key)
        comes_true(view, lambda: page.find_element(By.CSS_SELECTOR, f'[data-view="{view}"]').get_attribute(
            "aria-selected") == "true")


def stays_in_sight(page, out):
    """Tally, recording and undo at each size, at the end of the page too; nothing is wider than the screen."""
    for name, (width, height) in SIZES.items():
        is_resized(page, width, height)
        for end in (0, 1):
            page.execute_script("scrollTo(0, arguments[0] * document.body.scrollHeight)", end)
            for part in ("tally", "record", "undo"):
                box = page.execute_script("const b = arguments[0].getBoundingClientRect();"
                                          "return [b.left, b.top, b.right, b.bottom]", by_id(page, part))
                assert box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height, (name, part, box)
            if out:
                page.save_screenshot(str(out / f"{name}{'_end' if end else ''}.png"))
        high = page.execute_script("return document.getElementById('canvas').getBoundingClientRect().height")
        assert 0.3 * height < high < height, f"{name}: the picture is {high} px high"
        finds_nothing_serious(page, name)
        wide = page.execute_script("return document.documentElement.scrollWidth")
        assert wide <= width, f"{name}: {wide} px wide"
        if width < 1000:
            small = page.execute_script(
                "return [...document.querySelectorAll('button, input, select, summary')].filter(e => e.checkVisibility())"
                ".map(e => [e.id || e.ariaLabel || e.textContent, (e.closest('label') || e).getBoundingClientRect()])"
                ".filter(([n, b]) => b.width && Math.min(b.width, b.height) < 43.5).map(([n, b]) => `${n} ${b.width}x${b.height}`)")
            assert not small, small
    page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    page.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})
    page.execute_script("scrollTo(0, 0)")


def says_that_the_rig_died(page, rig, out):
    """Killed in mid-recording: no red tally stays, and the words are in sight at each size."""
    by_id(page, "take-name").clear()
    presses(page, "r")
    comes_true("recording", lambda: by_id(page, "tally").get_attribute("data-on") == "true")
    rig.process.kill()
    comes_true("not known", lambda: by_id(page, "tally").get_attribute("data-on") == "unknown")
    assert "was recording" in by_id(page, "tally").text and "NO CONNECTION" in page.title
    assert by_id(page, "lost").is_displayed() and not by_id(page, "record").is_enabled()
    text = by_id(page, "alarms-text").text
    assert "No connection to the rig" in text and "look at the rig" in text, text
    color = page.execute_script("return getComputedStyle(arguments[0]).backgroundColor", by_id(page, "tally"))
    assert color == "rgba(0, 0, 0, 0)", color
    for name, (width, height) in SIZES.items():
        is_resized(page, width, height)
        page.execute_script("scrollTo(0, document.body.scrollHeight)")
        assert page.execute_script("const b = arguments[0].getBoundingClientRect(); return b.top >= 0 && b.bottom <= innerHeight",
                                   by_id(page, "alarms")), name
        page.execute_script("scrollTo(0, 0)")
        if out:
            page.save_screenshot(str(out / f"{name}_lost.png"))
    print(f"killed: {text}")


def main():
    mixrig = sys.argv[1]
    out = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    skip_without_browser()
    with tempfile.TemporaryDirectory(prefix="mixrig-day-") as folder:
        os.environ["HOME"] = folder
        rig = Rig(mixrig, folder)
        page = browser(folder)
        try:
            page.get(rig.url)
            shows_a_live_picture(page)
            has_names(page)
            undoes_each_edit(page, rig)
            escape_cancels(page, rig)
            adds_models(page, rig)
            has_presets(page, rig)
            keeps_the_slate(page, rig)
            plays_takes(page, rig, out)
            shows_exposure(page, out)
            locks(page, rig)
            speaks_german(page, rig)
            stays_in_sight(page, out)
            assert age_ms(page) is not None
            says_that_the_rig_died(page, rig, out)
        finally:
            page.quit()
            rig.process.kill()
    print("passed")


if __name__ == "__main__":
    main()
