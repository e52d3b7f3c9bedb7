#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The operator's page of `mixrig run` in headless Chromium: what is done there is found in files.

usage: page_test.py MIXRIG [SCREENSHOT.png]
Exit status 77: skipped, Chromium or selenium is not there.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.error
import urllib.request

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("skipped: python3-selenium is not there: scripts/setup browser")
    sys.exit(77)

LIMIT_S = 120  # for what hangs; a loaded machine is slow


def comes_true(what, condition):
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"never: {what}")


class Rig:
    """A studio take, and `mixrig run --page` on it."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder)
        self.scene_file = self.folder / "take/scene.toml"
        take = self.folder / "take"
        subprocess.run([mixrig, "studio", take, "--plain", "--scenario", "walk", "--rig", "kinect2", "--seed", "7",
                        "--size", "640x512", "--frames", "40"], check=True, stdout=subprocess.DEVNULL)
        # At a rate that a loaded machine can follow.
        text = (take / "take.toml").read_text()
        (take / "take.toml").write_text(re.sub(r"rate_hz = [0-9.]+", "rate_hz = 10.0", text))
        self.log = open(self.folder / "log", "w+")
        self.source = f"take:{take}"
        self.start(mixrig)

    def start(self, mixrig):
        self.process = subprocess.Popen(
            [mixrig, "run", self.scene_file, "--source", self.source, "--backend", "cpu", "--page", "127.0.0.1:0",
             "--record-to", self.folder / "recordings"], stderr=self.log, stdout=subprocess.DEVNULL)
        self.url = comes_true("the page's address", self.address)

    def address(self):
        assert self.process.poll() is None, self.text()
        found = re.search(r"page: (http://\S+)", self.text())
        return found and found[1]

    def text(self):
        return (self.folder / "log").read_text()

    def state(self):
        with urllib.request.urlopen(self.url + "api/v1/state", timeout=30) as answer:
            return json.load(answer)

    def scene(self):
        with open(self.scene_file, "rb") as file:
            return tomllib.load(file)

    def object(self, name):
        return next(one for one in self.scene()["object"] if one["name"] == name)

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(LIMIT_S)


def browser(folder):
    options = Options()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--window-size=1280,1100", f"--user-data-dir={folder}/profile"):
        options.add_argument(argument)
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


def by_id(page, name):
    return page.find_element(By.ID, name)


def age_ms(page):
    text = by_id(page, "age").get_attribute("data-ms")
    return float(text) if text else None


def field(page, label, name):
    found = By.CSS_SELECTOR, f'[aria-label="{label} of {name}"]'
    return comes_true(f"{label} of {name}", lambda: page.find_elements(*found))[0]


def shows_a_live_picture(page):
    comes_true("a picture", lambda: age_ms(page) is not None)
    first = int(by_id(page, "canvas").get_attribute("data-frame"))
    comes_true("the next pictures", lambda: int(by_id(page, "canvas").get_attribute("data-frame")) > first + 5)
    ages = []
    for _ in range(20):
        ages.append(age_ms(page))
        time.sleep(0.05)
    print(f"age of the picture in the page: median {sorted(ages)[10]:.0f} ms, most {max(ages):.0f} ms")
    size = page.execute_script("const c = document.getElementById('canvas'); return [c.width, c.height]")
    assert size == [640, 512], size
    colors = page.execute_script(
        "const c = document.getElementById('canvas');"
        "return new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size")
    assert colors > 1000, f"{colors} colours: no picture"


def has_names(page):
    for control in page.find_elements(By.CSS_SELECTOR, "button, input, textarea, select"):
        assert control.accessible_name.strip(), control.get_attribute("outerHTML")


def drags_an_object(page, rig):
    thing = next(o for o in rig.state()["objects"] if o["at"])
    before = rig.object(thing["name"])["position_m"]
    handle = page.find_element(By.CSS_SELECTOR, f'[aria-label="Move {thing["name"]}"]')
    stage = by_id(page, "stage").rect
    dx, dy = int(-0.08 * stage["width"]), int(-0.04 * stage["height"])
    ActionChains(page).click_and_hold(handle).move_by_offset(dx // 2, dy // 2).move_by_offset(
        dx - dx // 2, dy - dy // 2).release().perform()
    want = [thing["at"][0] + dx / stage["width"], thing["at"][1] + dy / stage["height"]]

    def written():
        now = rig.object(thing["name"])["position_m"]
        at = next(o for o in rig.state()["objects"] if o["name"] == thing["name"])["at"]
        near = at and max(abs(at[i] - want[i]) for i in (0, 1)) < 0.01
        return near and now != before and now
    now = comes_true("the dragged object in scene.toml", written)
    assert abs(now[2] - before[2]) < 1e-6, "it stays on the floor"
    print(f"dragged {thing['name']}: {before} -> {now}")
    return thing["name"]


def moves_it_by_keys(page, rig, name):
    before = rig.object(name)["position_m"]
    page.find_element(By.CSS_SELECTOR, f'[aria-label="Move {name}"]').send_keys(Keys.ARROW_LEFT)
    comes_true("the object moved by a key",
               lambda: rig.object(name)["position_m"] != before)


def sets_it_on_a_surface(page, rig, name):
    """On the floor that was learned: it stands upright within the depth's noise, where the mark is let go."""
    before = rig.object(name)
    by_id(page, "onto").click()
    handle = page.find_element(By.CSS_SELECTOR, f'[aria-label="Move {name}"]')
    ActionChains(page).click_and_hold(handle).move_by_offset(12, 6).move_by_offset(12, 6).release().perform()
    now = comes_true("the object on the floor that is seen there", lambda: rig.object(name) != before and rig.object(name))
    by_id(page, "onto").click()
    x, y = now["rotation_xyzw"][:2]
    assert abs(1 - 2 * (x * x + y * y)) > 0.999, now  # cosine between its axis and the world's
    assert now["position_m"] != before["position_m"] and abs(now["position_m"][2]) < 0.03, now
    print(f"set {name} on the floor: {now['position_m']}")


def scales_and_hides_it(page, rig, name):
    scale = field(page, "scale", name)
    before = rig.object(name).get("scale", 1.0)
    scale.send_keys(Keys.ARROW_UP, Keys.TAB)
    comes_true("its scale", lambda: rig.object(name).get("scale", 1.0) > before)
    hide = field(page, "hide", name)
    for hidden in (True, False):
        hide.click()
        comes_true(f"hidden {hidden}", lambda: rig.object(name).get("hidden", False) == hidden)
        comes_true("the page knows", lambda: hide.get_attribute("aria-pressed") == str(hidden).lower())


def turns_it(page, rig, name):
    before = rig.object(name)
    field(page, "turn", name).send_keys(*[Keys.ARROW_RIGHT] * 10)
    comes_true("the turned object", lambda: rig.object(name).get("rotation_xyzw", before) != before.get(
        "rotation_xyzw", before) and abs(next(o for o in rig.state()["objects"] if o["name"] == name)["turn_deg"]) > 1)


def loads_and_removes_a_model(page, rig):
    model = next((rig.folder / "take").glob("**/*.glb"))
    copy = rig.folder / "new thing.glb"
    shutil.copy(model, copy)
    count = len(rig.scene()["object"])
    by_id(page, "upload").send_keys(str(copy))
    comes_true("the new object", lambda: len(rig.scene()["object"]) == count + 1)
    assert (rig.folder / "take/models/new_thing.glb").exists()
    removes(page, field(page, "remove", "new thing"))
    comes_true("the object is gone", lambda: len(rig.scene()["object"]) == count)
    comes_true("the run knows", lambda: len(rig.state()["objects"]) == count)


def removes(page, button):
    button.click()
    page.switch_to.alert.accept()


def switches_a_lamp(page, rig):
    name = rig.scene()["light"]["lamp"][0]["name"]
    strength = lambda: max(rig.scene()["light"]["lamp"][0]["intensity"])
    before = strength()
    for on in (False, True):
        field(page, "on", name).click()
        comes_true(f"the lamp {on}", lambda: (strength() > 0) == on)
        comes_true("the page knows", lambda: field(page, "on", name).get_attribute("aria-pressed") == str(on).lower())
    assert abs(strength() - before) < 1e-4, "it has what it had"


def colors_a_lamp(page, rig):
    name = rig.scene()["light"]["lamp"][0]["name"]
    page.execute_script(
        "const c = document.querySelector(arguments[0]); c.value = '#ff0000';"
        "c.dispatchEvent(new Event('change'))", f'[aria-label="color of {name}"]')

    def red():
        r, g, b = rig.scene()["light"]["lamp"][0]["intensity"]
        return g + b < 0.01 * r
    comes_true("the red lamp", red)


def removes_a_lamp(page, rig):
    lamps = rig.scene()["light"]["lamp"]
    removes(page, field(page, "remove", lamps[-1]["name"]))
    comes_true("the lamp is gone", lambda: len(rig.scene()["light"]["lamp"]) == len(lamps) - 1)


def takes_changes(page):
    by_id(page, "learn").click()
    comes_true("that nothing waits", lambda: "waits to be accepted" in by_id(page, "log").text)


def saves(page, rig):
    with_preview = json.dumps({"turn_deg": 77, "preview": True}).encode()
    name = rig.scene()["object"][0]["name"]
    request = urllib.request.Request(rig.url + f"api/v1/objects/{name}", with_preview,
                                     {"Content-Type": "application/json"}, method="PUT")
    urllib.request.urlopen(request, timeout=30)
    before = rig.scene_file.read_text()
    by_id(page, "save").click()
    comes_true("the saved preview", lambda: rig.scene_file.read_text() != before)


def dims_a_lamp(page, rig):
    lamp = rig.scene()["light"]["lamp"][0]
    strength = field(page, "strength", lamp["name"])
    strength.send_keys(*[Keys.ARROW_LEFT] * 20)

    def dimmed():
        now = rig.scene()["light"]["lamp"][0]["intensity"]
        return max(now) < 0.6 * max(lamp["intensity"]) and now
    print(f"dimmed {lamp['name']}: {lamp['intensity']} -> {comes_true('the dimmed lamp', dimmed)}")


def adds_a_lamp_where_it_is_seen(page, rig):
    """On the wall in the upper middle of the picture, by the learned room."""
    count = len(rig.scene()["light"]["lamp"])
    page.find_element(By.CSS_SELECTOR, '#lamp-where option[value=""]').click()
    by_id(page, "add-lamp").click()
    ActionChains(page).move_to_element_with_offset(by_id(page, "stage"), 0, int(
        -0.35 * by_id(page, "stage").rect["height"])).click().perform()
    comes_true("the lamp on the wall", lambda: len(rig.scene()["light"]["lamp"]) == count + 1)
    comes_true("the run knows", lambda: len(rig.state()["lamps"]) == count + 1)
    lamp = rig.state()["lamps"][-1]
    assert lamp["at"] and abs(lamp["at"][0] - 0.5) < 0.02 and abs(lamp["at"][1] - 0.15) < 0.02, lamp
    print(f"a lamp where the wall is seen: {lamp['position_m']}")


def adds_a_lamp(page, rig):
    count = len(rig.scene()["light"]["lamp"])
    page.find_element(By.CSS_SELECTOR, '#lamp-where option[value="above_floor_m"]').click()
    by_id(page, "add-lamp").click()
    ActionChains(page).move_to_element_with_offset(by_id(page, "stage"), 0, int(
        0.4 * by_id(page, "stage").rect["height"])).click().perform()
    comes_true("the added lamp", lambda: len(rig.scene()["light"]["lamp"]) == count + 1)


def focuses(page, rig):
    """Depth of field: on, by a click, by numbers, off; each is in scene.toml."""
    focus = lambda: rig.scene().get("focus")
    by_id(page, "focus-on").click()
    comes_true("a focus in scene.toml", focus)
    comes_true("the page knows", lambda: by_id(page, "focus-on").get_attribute("aria-pressed") == "true")
    sharp = comes_true("a picture", lambda: edge_strength(page))
    stage = by_id(page, "stage").rect
    by_id(page, "focus-pick").click()
    ActionChains(page).move_to_element_with_offset(by_id(page, "stage"), int(-0.25 * stage["width"]), int(
        0.25 * stage["height"])).click().perform()
    comes_true("the pixel in scene.toml", lambda: abs(focus()["pixel"][0] - 160) < 4 and
               abs(focus()["pixel"][1] - 384) < 4)
    comes_true("the ring", lambda: page.find_elements(By.CSS_SELECTOR, ".handle.focus"))
    for name, text, key in (("focus-distance", "0.5", "distance_m"), ("focus-number", "0.5", "f_number")):
        types(page, name, text)
        comes_true(f"{key} in scene.toml", lambda: focus().get(key) == 0.5)
    assert "pixel" not in focus(), focus()
    comes_true("a blurred room", lambda: edge_strength(page) < 0.7 * sharp)
    by_id(page, "focus-on").click()
    comes_true("no focus in scene.toml", lambda: not focus())
    comes_true("a sharp room", lambda: edge_strength(page) > 0.9 * sharp)


def types(page, name, text):
    """In place of what is there; what the run tells meanwhile does not come between."""
    by_id(page, name).send_keys(Keys.CONTROL, "a", Keys.NULL, text, Keys.TAB)


def edge_strength(page):
    return page.execute_script(
        "const c = document.getElementById('canvas');"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let sum = 0; for (let i = 4; i < d.length; i += 4) sum += Math.abs(d[i] - d[i - 4]);"
        "return sum / d.length")


def learns_the_room(page, rig):
    """All of the background anew, while the run goes on; once ended in the middle."""
    def begins():
        by_id(page, "scan").click()
        comes_true("progress", lambda: by_id(page, "scan-progress").is_displayed())
    begins()
    by_id(page, "scan").click()
    comes_true("the end of it", lambda: rig.state()["scan"]["total"] == 0)
    begins()
    comes_true("looks", lambda: rig.state()["scan"]["done"] > 2)
    comes_true("the learned room", lambda: "learned anew" in by_id(page, "log").text)
    assert rig.state()["scan"]["total"] == 0


def records(page, rig, mixrig):
    by_id(page, "take-name").send_keys("shot 1")
    by_id(page, "take-notes").send_keys('said "good"')
    by_id(page, "record").click()
    comes_true("recording", lambda: by_id(page, "tally").get_attribute("data-on") == "true")
    comes_true("2 s of it", lambda: rig.state()["recording"]["seconds"] >= 2)
    by_id(page, "record").click()
    comes_true("the end of it", lambda: by_id(page, "tally").get_attribute("data-on") == "false")
    shot = rig.folder / "recordings/shot 1"
    note = tomllib.loads((shot / "recording.toml").read_text())
    assert note["notes"] == 'said "good"' and note["seconds"] >= 2, note
    info = subprocess.run([mixrig, "info", shot / "composite"], check=True, capture_output=True, text=True).stdout
    assert "640x512" in info, info
    print(f"recorded {note['frames']:.0f} frames in {note['seconds']:.1f} s, {note['lost']:.0f} lost")
    # The name is taken now: the page says so.
    by_id(page, "record").click()
    comes_true("the refusal", lambda: "exists" in by_id(page, "message").text)


class LiveRig(Rig):
    """Cameras of the studio as devices: their exposure can be set."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder) / "live"
        self.folder.mkdir()
        self.scene_file = self.folder / "scene.toml"
        self.scene_file.write_text('[camera]\npose = "identity"\n')
        studio = 'uri = "studio:sweep,7,sr3000,,64x48/'
        self.rig_file = self.folder / "rig.toml"
        self.rig_file.write_text(f'format = 1\n[[camera]]\nname = "color"\n{studio}target"\n'
                                 f'exposure_ms = 8.0  # at rest\n[depth]\n{studio}tof"\n'
                                 f'[pan_tilt]\n{studio}head"\n')
        self.follow(mixrig)

    def follow(self, mixrig):
        self.source = f"rig:{self.rig_file}"
        self.log = open(self.folder / "log", "w+")
        self.start(mixrig)

    def exposure_ms(self):
        with open(self.rig_file, "rb") as file:
            return tomllib.load(file)["camera"][0]["exposure_ms"]


def sets_the_exposure(page, mixrig, folder):
    rig = LiveRig(mixrig, folder)
    try:
        page.get(rig.url)
        comes_true("the cameras", lambda: by_id(page, "cameras-panel").is_displayed())
        has_names(page)
        bright = comes_true("a picture", lambda: brightness(page))
        number = field(page, "exposure, ms as number", "color")
        comes_true("the value", lambda: number.get_attribute("value") == "8")
        number.clear()
        number.send_keys("2", Keys.TAB)
        comes_true("the exposure in rig.toml", lambda: rig.exposure_ms() == 2)
        assert "# at rest" in rig.rig_file.read_text()
        comes_true("a darker picture", lambda: brightness(page) < 0.7 * bright)
        assert rig.state()["cameras"][0]["settings"][0]["value"] == 2
        assert rig.stop() == 0, rig.text()
        rig.log.truncate(0)
        rig.start(mixrig)
        comes_true("the exposure after a restart", lambda: (rig.state()["cameras"] or [{"settings": [{"value": 0}]}])
                   [0]["settings"][0]["value"] == 2)
        print(f"exposure 8 -> 2 ms: brightness {bright:.0f} -> below {0.7 * bright:.0f}, kept over a restart")
    finally:
        rig.process.kill()


class HalfLost(LiveRig):
    """The depth camera's recording ends long before that of the colour camera."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder) / "lost"
        self.folder.mkdir()
        self.scene_file = self.folder / "scene.toml"
        self.scene_file.write_text('[camera]\npose = "identity"\n')
        for name, frames in (("long", 300), ("short", 10)):
            subprocess.run([mixrig, "studio", self.folder / name, "--plain", "--scenario", "walk", "--rig", "sr3000",
                            "--seed", "7", "--size", "64x48", "--frames", str(frames)], check=True,
                           stdout=subprocess.DEVNULL)
        self.rig_file = self.folder / "rig.toml"
        self.rig_file.write_text(f'format = 1\n[[camera]]\nname = "color"\nuri = "take:{self.folder}/long/color"\n'
                                 f'[depth]\nname = "depth"\nuri = "take:{self.folder}/short/depth"\n')
        self.follow(mixrig)


class HeadRig(LiveRig):
    """With a head that the pose follows, and the calibration of a take of the same rig."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder) / "head"
        take = self.folder / "take"
        subprocess.run([mixrig, "studio", take, "--plain", "--scenario", "sweep", "--rig", "sr3000", "--seed", "31",
                        "--size", "64x48", "--field", "80x60", "--view-frames", "2"], check=True,
                       stdout=subprocess.DEVNULL)
        self.scene_file = self.folder / "scene.toml"
        base = re.search(r"\[camera.world_from_base\]\n.*\n.*\n", (take / "scene_pan_tilt.toml").read_text())[0]
        self.scene_file.write_text(f'# ours\n[camera]\npose = "pan_tilt"\n{base}')
        studio = 'uri = "studio:sweep,31,sr3000,,64x48/'
        self.rig_file = self.folder / "rig.toml"
        self.rig_file.write_text(f'format = 1\ncalibration = "take/truth/calibration.toml"\n[[camera]]\n'
                                 f'name = "color"\n{studio}target"\n[depth]\n{studio}tof"\n'
                                 f'[pan_tilt]\n{studio}head"\n')
        self.follow(mixrig)

    def sweep(self):
        return self.state()["sweep"]


def scans_with_the_head(page, mixrig, folder):
    """Cancelled once, then to the end; the room is the background of the next start."""
    rig = HeadRig(mixrig, folder)
    try:
        page.get(rig.url)
        comes_true("a picture", lambda: age_ms(page) is not None)
        comes_true("the scan", lambda: by_id(page, "sweep").is_enabled())
        for name, degrees in (("sweep-pan", "80"), ("sweep-tilt", "60")):
            types(page, name, degrees)
        by_id(page, "sweep").click()
        comes_true("progress", lambda: by_id(page, "sweep-progress").is_displayed() and rig.sweep()["done"] > 0)
        before = int(by_id(page, "canvas").get_attribute("data-frame"))
        comes_true("the run goes on", lambda: int(by_id(page, "canvas").get_attribute("data-frame")) > before + 2)
        by_id(page, "sweep").click()
        comes_true("the end of it", lambda: rig.sweep()["phase"] == "idle")
        assert not rig.sweep()["error"] and not list((rig.folder / "rooms").iterdir()), rig.sweep()
        comes_true("the page knows", lambda: by_id(page, "sweep").text.startswith("Scan"))
        by_id(page, "sweep").click()
        comes_true("the room", lambda: rig.sweep()["phase"] == "idle" and rig.sweep()["folder"])
        comes_true("the page says so", lambda: "next start" in by_id(page, "sweep-state").text)
        scene = rig.scene()
        assert scene["background"]["model"] == "rooms/room 1", scene
        assert rig.scene_file.read_text().startswith("# ours"), "comments stay"
        assert not list((rig.folder / "rooms").glob("*.sweep"))
        assert rig.stop() == 0, rig.text()
        rig.log.truncate(0)
        rig.start(mixrig)
        comes_true("a background after a restart", lambda: rig.state()["background"]["possible"])
        print(f"scanned {rig.folder / scene['background']['model']}")
    finally:
        rig.process.kill()


def a_recording_is_not_scanned(page, rig):
    assert not by_id(page, "sweep").is_enabled()
    comes_true("the reason", lambda: "a recording is played" in by_id(page, "sweep-state").text)
    request = urllib.request.Request(rig.url + "api/v1/sweep/start", b"{}", {"Content-Type": "application/json"})
    try:
        urllib.request.urlopen(request, timeout=30)
        raise AssertionError("a recording was scanned")
    except urllib.error.HTTPError as refused:
        assert refused.code == 409, refused


def shows_a_lost_device(page, mixrig, folder):
    rig = HalfLost(mixrig, folder)
    try:
        page.get(rig.url)
        line = comes_true("the lost depth camera", lambda: [
            one.text for one in page.find_elements(By.CSS_SELECTOR, "#streams .bad") if "depth" in one.text])
        assert "check cable" in line[0], line
        assert age_ms(page) is not None
        print(f"a lost device: {line[0]}")
    finally:
        rig.process.kill()


def brightness(page):
    return page.execute_script(
        "if (!Picture.frame) return 0;"
        "const c = document.getElementById('canvas');"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let sum = 0; for (let i = 0; i < d.length; i += 4) sum += d[i] + d[i + 1] + d[i + 2];"
        "return 4 * sum / 3 / d.length")


def freezes(page):
    by_id(page, "freeze").click()
    comes_true("the age over a frozen picture", lambda: by_id(page, "stale").is_displayed())
    assert "frozen" in by_id(page, "stale").text
    by_id(page, "freeze").click()
    comes_true("a live picture again", lambda: not by_id(page, "stale").is_displayed())


def two_pages_agree(page):
    first = page.current_window_handle
    url = page.current_url
    page.switch_to.new_window("window")
    page.get(url)
    comes_true("the second page", lambda: age_ms(page) is not None)
    page.find_element(By.CSS_SELECTOR, '[data-view="key"]').click()
    page.switch_to.window(first)
    tab = page.find_element(By.CSS_SELECTOR, '[data-view="key"]')
    comes_true("the other page's view", lambda: tab.get_attribute("aria-selected") == "true")
    page.refresh()
    comes_true("the view after a reload", lambda: page.find_element(
        By.CSS_SELECTOR, '[data-view="key"]').get_attribute("aria-selected") == "true")
    comes_true("its picture", lambda: age_ms(page) is not None)
    page.find_element(By.CSS_SELECTOR, '[data-view="composite"]').click()


def says_when_the_rig_is_gone(page, rig):
    assert rig.stop() == 0, rig.text()
    comes_true("no connection", lambda: "no connection" in by_id(page, "summary").text)
    comes_true("an old picture that says so", lambda: by_id(page, "stale").is_displayed())


def of_the_scene(rig):
    """Objects, lamps and depth of field of the state; where they are in the picture is of its frame."""
    state = rig.state()
    things = state["objects"] + state["lamps"]
    return {"things": [{key: value for key, value in thing.items() if key != "at"} for thing in things], "focus": state["focus"]}


def all_of_it_survives_a_restart(rig, mixrig):
    """After an object, its turn and scale, lamps and depth of field were changed by the page."""
    put = urllib.request.Request(rig.url + "api/v1/focus", b'{"at": [0.25, 0.5], "f_number": 4}',
                                 {"Content-Type": "application/json"}, method="PUT")
    urllib.request.urlopen(put, timeout=30)
    comes_true("the focus in the state", lambda: rig.state()["focus"]["f_number"] == 4)
    before = of_the_scene(rig)
    assert len(before["things"]) > 2, before
    assert rig.stop() == 0, rig.text()
    rig.log.truncate(0)
    rig.start(mixrig)
    after = of_the_scene(rig)
    assert after == before, f"{before}\n{after}"
    print(f"after a restart: {len(after['things'])} objects and lamps, and the focus, as before")


def console_is_clean(page):
    bad = [entry for entry in page.get_log("browser") if "Content Security Policy" in entry["message"]]
    assert not bad, bad


def main():
    mixrig = sys.argv[1]
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        print("skipped: chromium or chromium-driver is not there: scripts/setup browser")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="mixrig-page-") as folder:
        os.environ["HOME"] = folder
        rig = Rig(mixrig, folder)
        page = browser(folder)
        try:
            page.get(rig.url)
            shows_a_live_picture(page)
            has_names(page)
            console_is_clean(page)
            name = drags_an_object(page, rig)
            sets_it_on_a_surface(page, rig, name)
            moves_it_by_keys(page, rig, name)
            if len(sys.argv) > 2:
                time.sleep(1)
                page.save_screenshot(sys.argv[2])
            scales_and_hides_it(page, rig, name)
            turns_it(page, rig, name)
            loads_and_removes_a_model(page, rig)
            saves(page, rig)
            dims_a_lamp(page, rig)
            switches_a_lamp(page, rig)
            colors_a_lamp(page, rig)
            adds_a_lamp(page, rig)
            adds_a_lamp_where_it_is_seen(page, rig)
            removes_a_lamp(page, rig)
            takes_changes(page)
            focuses(page, rig)
            a_recording_is_not_scanned(page, rig)
            learns_the_room(page, rig)
            records(page, rig, mixrig)
            freezes(page)
            two_pages_agree(page)
            all_of_it_survives_a_restart(rig, mixrig)
            page.get(rig.url)
            comes_true("a picture after the restart", lambda: age_ms(page) is not None)
            says_when_the_rig_is_gone(page, rig)
            sets_the_exposure(page, mixrig, folder)
            scans_with_the_head(page, mixrig, folder)
            shows_a_lost_device(page, mixrig, folder)
        finally:
            page.quit()
            rig.process.kill()
    print("passed")


if __name__ == "__main__":
    main()
