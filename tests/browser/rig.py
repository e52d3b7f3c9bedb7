# SPDX-License-Identifier: Apache-2.0
"""Runs of mixrig with a page, the browser, and what all tests ask of both."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib
import urllib.request

try:
    from selenium import webdriver
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("skipped: python3-selenium is not there: scripts/setup browser")
    sys.exit(77)

STUDIO_TAKE = pathlib.Path(__file__).parent.parent / "support/studio_take"
LIMIT_S = 120  # for what hangs; a loaded machine is slow


# Errors of requests for parts of the page, scene or state that do not exist yet or are being
# replaced.
NOT_YET = (WebDriverException, LookupError, StopIteration, OSError)


def skip_without_browser():
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        print("skipped: chromium or chromium-driver is not there: scripts/setup browser")
        sys.exit(77)


def comes_true(what, condition):
    end = time.monotonic() + LIMIT_S
    why = None
    while time.monotonic() < end:
        try:
            value = condition()
            if value:
                return value
            why = None
        except NOT_YET as error:
            why = error
        time.sleep(0.1)
    raise AssertionError(f"never: {what}") from why


def play_at(rate_hz, take):
    """Frames a second of a take, in place of its own."""
    text = (take / "take.toml").read_text()
    (take / "take.toml").write_text(re.sub(r"rate_hz = [0-9.]+", f"rate_hz = {rate_hz:.1f}", text))


def render_take(mixrig, folder, options):
    """A take; what any test of this build has rendered is copied."""
    subprocess.run([STUDIO_TAKE, mixrig, folder, "--plain", *options.split()], check=True, stdout=subprocess.DEVNULL)


class Rig:
    """A studio take, and `mixrig run --page` on it."""

    environment = {}

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder)
        self.scene_file = self.folder / "take/scene.toml"
        take = self.folder / "take"
        render_take(mixrig, take, "--scenario walk --rig kinect2 --seed 7 --size 320x256 --frames 24")
        play_at(10, take)  # which a loaded machine can follow
        self.log = open(self.folder / "log", "w+")
        self.source = f"take:{take}"
        self.start(mixrig)

    def start(self, mixrig):
        self.process = subprocess.Popen(
            [mixrig, "run", self.scene_file, "--source", self.source, "--backend", "cpu", "--page", "127.0.0.1:0",
             "--record-to", self.folder / "recordings"], stderr=self.log, stdout=subprocess.DEVNULL,
            env=os.environ | self.environment)
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


class LiveRig(Rig):
    """Cameras of the studio as devices: their exposure can be set. Without plug-ins of GStreamer."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder) / "live"
        (self.folder / "no_plugins").mkdir(parents=True)
        self.environment = {"GST_PLUGIN_SYSTEM_PATH_1_0": str(self.folder / "no_plugins"),
                            "GST_REGISTRY_1_0": str(self.folder / "registry")}
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


class HalfLost(LiveRig):
    """The depth camera's recording ends long before that of the colour camera."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder) / "lost"
        self.folder.mkdir()
        self.scene_file = self.folder / "scene.toml"
        self.scene_file.write_text('[camera]\npose = "identity"\n')
        for name, frames, rate_hz in (("long", 40, 2), ("short", 10, 30)):
            render_take(mixrig, self.folder / name, f"--scenario walk --rig sr3000 --seed 7 --size 64x48 --frames {frames}")
            play_at(rate_hz, self.folder / name)
        self.rig_file = self.folder / "rig.toml"
        self.rig_file.write_text(f'format = 1\n[[camera]]\nname = "color"\nuri = "take:{self.folder}/long/color"\n'
                                 f'[depth]\nname = "depth"\nuri = "take:{self.folder}/short/depth"\n')
        self.follow(mixrig)


class HeadRig(LiveRig):
    """With a head that the pose follows, and the calibration of a take of the same rig."""

    def __init__(self, mixrig, folder):
        self.folder = pathlib.Path(folder) / "head"
        take = self.folder / "take"
        render_take(mixrig, take, "--scenario sweep --rig sr3000 --seed 31 --size 64x48 --field 80x60 --view-frames 2")
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


def browser(folder):
    options = Options()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--window-size=1280,2400", f"--user-data-dir={folder}/profile"):
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


def types(control, text):
    """In place of what is there; what the run tells meanwhile does not come between."""
    control.send_keys(Keys.CONTROL, "a", Keys.NULL, text, Keys.TAB)


def has_names(page):
    shown = [one for one in page.find_elements(By.CSS_SELECTOR, "button, input, textarea, select") if one.is_displayed()]
    assert len(shown) > 10, len(shown)
    for control in shown:
        assert control.accessible_name.strip(), control.get_attribute("outerHTML")


def finds_nothing_serious(page, where):
    """axe-core sees no serious fault. MIXRIG_AXE: axe.min.js of the npm package axe-core; without it nothing is judged."""
    if not os.environ.get("MIXRIG_AXE"):
        return
    page.execute_script(pathlib.Path(os.environ["MIXRIG_AXE"]).read_text())
    page.set_script_timeout(60)
    found = page.execute_async_script("const done = arguments[0]; axe.run().then(r => done(r.violations.map("
                                      "v => [v.impact, v.id, v.nodes.length, v.nodes[0].html])))")
    grave = [fault for fault in found if fault[0] in ("serious", "critical")]
    assert not grave, (where, grave)
    print(f"axe-core, {where}: nothing serious, {len(found)} others {[fault[1] for fault in found]}")


def presses(page, *keys):
    """Keys of the page, with none of its controls in use."""
    page.execute_script("document.activeElement.blur()")
    chain = ActionChains(page)
    for key in keys[:-1]:
        chain.key_down(key)
    chain.send_keys(keys[-1])
    for key in keys[:-1]:
        chain.key_up(key)
    chain.perform()
