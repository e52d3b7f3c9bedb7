#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The operator's page of `mixrig run` in headless Chromium: what is done there is found in files.

usage: page_test.py MIXRIG [SCREENSHOT.png]
Exit status 77: skipped, Chromium or selenium is not there.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.error
import urllib.request

from rig import (By, HalfLost, HeadRig, LiveRig, Rig, age_ms, browser, by_id, comes_true, field, has_names,
                 skip_without_browser, types)
from picture import (brightness, comes_by_webrtc, falls_back_to_mjpeg, focuses, freezes, says_when_the_rig_is_gone,
                     says_why_it_is_mjpeg, shows_a_live_picture, two_pages_have_two_views)
from things import (adds_a_lamp, adds_a_lamp_where_it_is_seen, colors_a_lamp, dims_a_lamp, drags_an_object,
                    loads_and_removes_a_model, moves_it_by_keys, removes_a_lamp, saves, scales_and_hides_it,
                    sets_it_on_a_surface, switches_a_lamp, turns_it)


def takes_changes(page):
    """Nothing waits, unless the run has lasted so long that it took the played person for a change."""
    by_id(page, "learn").click()
    comes_true("what became of it", lambda: re.search("waits to be accepted|is background from now on|is hidden by people",
                                                      by_id(page, "log").text))


def learns_the_room(page, rig):
    """All of the background anew, while the run goes on; once ended in the middle."""
    def begins():
        by_id(page, "scan").click()
        comes_true("progress", lambda: by_id(page, "scan-progress").is_displayed())
    begins()
    by_id(page, "scan").click()
    comes_true("the end of it", lambda: rig.state()["scan"]["total"] == 0)
    comes_true("the page knows", lambda: not by_id(page, "scan-progress").is_displayed())
    begins()
    comes_true("looks", lambda: rig.state()["scan"]["done"] > 2)
    comes_true("the learned room", lambda: "learned anew" in by_id(page, "log").text)
    assert rig.state()["scan"]["total"] == 0


def tells_the_disk(page, rig):
    """What is left where recordings go, by the system's own figure."""
    def told_gb():
        found = re.search(r"([0-9.]+) GB free", by_id(page, "health").text)
        return found and float(found[1])
    comes_true("the disk", lambda: told_gb() is not None and
               abs(told_gb() - shutil.disk_usage(rig.folder).free / 1e9) < 0.3)


def records(page, rig, mixrig):
    by_id(page, "take-name").send_keys("shot 1")
    by_id(page, "take-notes").send_keys('said "good"')
    by_id(page, "record").click()
    comes_true("recording", lambda: by_id(page, "tally").get_attribute("data-on") == "true")
    assert by_id(page, "tally").text == "recording shot 1"
    assert rig.state()["recording"]["tally"] == "record"
    # The run's clock is ahead of the stamp of the last frame that is kept.
    comes_true("2 s of it", lambda: rig.state()["recording"]["seconds"] >= 2.5)
    by_id(page, "record").click()
    comes_true("the end of it", lambda: by_id(page, "tally").get_attribute("data-on") == "false")
    assert by_id(page, "tally").text == "not recording"
    assert rig.state()["recording"]["tally"] == "preview"
    shot = rig.folder / "recordings/shot 1"
    note = tomllib.loads((shot / "recording.toml").read_text())
    assert note["notes"] == 'said "good"' and note["seconds"] >= 2, note
    info = subprocess.run([mixrig, "info", shot / "composite"], check=True, capture_output=True, text=True).stdout
    assert "320x256" in info, info
    print(f"recorded {note['frames']:.0f} frames in {note['seconds']:.1f} s, {note['lost']:.0f} lost")
    # The name exists now: the page proposes the next.
    comes_true("the next name", lambda: by_id(page, "take-name").get_attribute("value") == "shot 1 take 2")


def sets_the_exposure(page, mixrig, folder):
    rig = LiveRig(mixrig, folder)
    try:
        page.get(rig.url)
        says_why_it_is_mjpeg(page)
        comes_true("the cameras", lambda: by_id(page, "cameras-panel").is_displayed())
        has_names(page)
        bright = comes_true("a picture", lambda: brightness(page))
        number = field(page, "exposure, ms as number", "color")
        comes_true("the value", lambda: number.get_attribute("value") == "8")
        types(number, "2")
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


def scans_with_the_head(page, mixrig, folder):
    """Cancelled once, then to the end; the room is the background of the next start."""
    rig = HeadRig(mixrig, folder)
    try:
        page.get(rig.url)
        comes_true("a picture", lambda: age_ms(page) is not None)
        comes_true("the scan", lambda: by_id(page, "sweep").is_enabled())
        for name, degrees in (("sweep-pan", "80"), ("sweep-tilt", "60")):
            types(by_id(page, name), degrees)
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
        others = [one.text for one in page.find_elements(By.CSS_SELECTOR, "#streams li:not(.bad)")]
        assert len(others) == 1 and others[0].startswith("color: ok, "), others
        assert age_ms(page) is not None
        print(f"a lost device: {line[0]}; the other: {others[0]}")
    finally:
        rig.process.kill()


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
    skip_without_browser()
    with tempfile.TemporaryDirectory(prefix="mixrig-page-") as folder:
        os.environ["HOME"] = folder
        rig = Rig(mixrig, folder)
        page = browser(folder)
        try:
            page.get(rig.url)
            shows_a_live_picture(page)
            comes_by_webrtc(page, rig)
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
            tells_the_disk(page, rig)
            freezes(page)
            falls_back_to_mjpeg(page)
            two_pages_have_two_views(page, rig)
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
