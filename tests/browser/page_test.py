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
        self.process = subprocess.Popen(
            [mixrig, "run", self.scene_file, "--source", f"take:{take}", "--backend", "cpu", "--page", "127.0.0.1:0",
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
    return page.find_element(By.CSS_SELECTOR, f'[aria-label="{label} of {name}"]')


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
    for control in page.find_elements(By.CSS_SELECTOR, "button, input, textarea"):
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


def dims_a_lamp(page, rig):
    lamp = rig.scene()["light"]["lamp"][0]
    strength = field(page, "strength", lamp["name"])
    strength.send_keys(*[Keys.ARROW_LEFT] * 20)

    def dimmed():
        now = rig.scene()["light"]["lamp"][0]["intensity"]
        return max(now) < 0.6 * max(lamp["intensity"]) and now
    print(f"dimmed {lamp['name']}: {lamp['intensity']} -> {comes_true('the dimmed lamp', dimmed)}")


def adds_a_lamp(page, rig):
    count = len(rig.scene()["light"]["lamp"])
    by_id(page, "add-lamp").click()
    ActionChains(page).move_to_element_with_offset(by_id(page, "stage"), 0, int(
        0.4 * by_id(page, "stage").rect["height"])).click().perform()
    comes_true("the added lamp", lambda: len(rig.scene()["light"]["lamp"]) == count + 1)


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
            moves_it_by_keys(page, rig, name)
            if len(sys.argv) > 2:
                time.sleep(1)
                page.save_screenshot(sys.argv[2])
            scales_and_hides_it(page, rig, name)
            dims_a_lamp(page, rig)
            adds_a_lamp(page, rig)
            records(page, rig, mixrig)
            freezes(page)
            two_pages_agree(page)
            says_when_the_rig_is_gone(page, rig)
        finally:
            page.quit()
            rig.process.kill()
    print("passed")


if __name__ == "__main__":
    main()
