# SPDX-License-Identifier: Apache-2.0
"""The live picture of the page: how old it is, what it shows, by WebRTC and by MJPEG."""
import os
import re
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from rig import age_ms, by_id, comes_true, types


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
    assert size == [320, 256], size
    colors = page.execute_script(
        "const c = document.getElementById('canvas');"
        "return new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size")
    assert colors > 1000, f"{colors} colours: no picture"


def comes_by(page):
    return by_id(page, "age").get_attribute("data-by")


def comes_by_webrtc(page, rig):
    """Its colours are those of the JPEG of the same frame, another view comes by it too, and the rig opens
    ports to this machine alone."""
    comes_true("a picture by WebRTC", lambda: comes_by(page) == "WebRTC")
    assert "by WebRTC" in by_id(page, "age").text
    drawn = page.execute_async_script(AGES)
    print(f"by WebRTC: age of a picture when it is drawn, median {sorted(drawn)[10]:.0f} ms, most {max(drawn):.0f} ms")
    page.set_script_timeout(60)
    mean, rms = page.execute_async_script(SAME_FRAME)
    print(f"by WebRTC less JPEG, of 255: mean {mean}, root mean square {rms:.1f}")
    assert max(abs(one) for one in mean) < 3 and rms < 12, (mean, rms)
    comes_true("one port of each kind", lambda: [table for table, _ in open_ports(rig.process.pid)] == ["tcp", "udp"])
    ports = open_ports(rig.process.pid)
    assert all(address == "0100007F" for _, address in ports), ports
    page.find_element(By.CSS_SELECTOR, '[data-view="matte"]').click()
    comes_true("another view by it", lambda: page.execute_script(GREY))
    page.find_element(By.CSS_SELECTOR, '[data-view="composite"]').click()
    comes_true("the composite again", lambda: not page.execute_script(GREY))
    comes_true("WebRTC to the end", lambda: comes_by(page) == "WebRTC")


def falls_back_to_mjpeg(page):
    """Where no more pictures come by WebRTC, which is tried again, and in a browser that has none."""
    def by_mjpeg(why):
        comes_true(f"MJPEG: {why}", lambda: comes_by(page) == "MJPEG" and re.search(
            why, by_id(page, "age").get_attribute("title")))
        before = int(by_id(page, "canvas").get_attribute("data-frame") or 0)
        comes_true("pictures go on", lambda: int(by_id(page, "canvas").get_attribute("data-frame") or 0) > before + 3)
    page.execute_script("Picture.webrtc.peer.close()")
    by_mjpeg("no WebRTC: .")  # who notices first says why
    comes_true("WebRTC again by itself", lambda: comes_by(page) == "WebRTC")
    without = page.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": "delete window.RTCPeerConnection"})
    page.refresh()
    by_mjpeg("this browser has no WebRTC")
    page.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", without)
    page.refresh()
    comes_true("WebRTC again", lambda: comes_by(page) == "WebRTC")


def says_why_it_is_mjpeg(page):
    """Of a rig without the plug-ins."""
    comes_true("a reason", lambda: "gstreamer1.0-plugins-bad" in by_id(page, "age").get_attribute("title"))
    comes_true("a picture", lambda: age_ms(page) is not None)
    assert comes_by(page) == "MJPEG" and "by MJPEG" in by_id(page, "age").text


def open_ports(pid):
    """(table, address) of the ports at which a process takes connections or datagrams."""
    mine = {re.sub(r"\D", "", os.readlink(f"/proc/{pid}/fd/{fd}")) for fd in os.listdir(f"/proc/{pid}/fd")
            if os.readlink(f"/proc/{pid}/fd/{fd}").startswith("socket:")}
    found = []
    for table in ("tcp", "tcp6", "udp", "udp6"):
        with open(f"/proc/{pid}/net/{table}") as lines:
            for line in list(lines)[1:]:
                words = line.split()
                if words[9] in mine and (table.startswith("udp") or words[3] == "0A"):
                    found.append((table, words[1].split(":")[0]))
    return found


AGES = """
const done = arguments[0], ages = [], drawn = Picture.drawn;
Picture.drawn = function (...all) {
  drawn.apply(this, all);
  ages.push(this.age_ms());
  if (ages.length < 20) return;
  Picture.drawn = drawn;
  done(ages);
};"""

# Difference between the canvas and the JPEG of the frame that it states.
SAME_FRAME = """
const done = arguments[0], jpegs = new Map(), videos = new Map(), drawn = Picture.drawn, stop = new AbortController();
const pixels = image => {
  const { width, height } = document.getElementById('canvas'), g = new OffscreenCanvas(width, height).getContext('2d');
  g.drawImage(image, 0, 0);
  return g.getImageData(0, 0, width, height).data;
};
const check = frame => {
  const a = videos.get(frame), b = jpegs.get(frame);
  if (!a || !b || stop.signal.aborted) return;
  Picture.drawn = drawn;
  stop.abort();
  const mean = [0, 0, 0];
  let square = 0;
  for (let i = 0; i < a.length; ++i)
    if (i % 4 < 3) { mean[i % 4] += 4 * (a[i] - b[i]) / a.length; square += (a[i] - b[i]) ** 2 / (0.75 * a.length); }
  done([mean, Math.sqrt(square)]);
};
Picture.drawn = function (...all) {
  drawn.apply(this, all);
  if (this.by === 'WebRTC') { videos.set(this.frame, pixels(document.getElementById('canvas'))); check(this.frame); }
};
(async () => {
  const reader = (await fetch('/api/v1/picture/composite.mjpeg', { signal: stop.signal })).body.getReader();
  for (let held = new Uint8Array(0); !stop.signal.aborted;) {
    const { value } = await reader.read();
    held = new Uint8Array([...held, ...value]);
    for (let part = nextPart(held); part; part = nextPart(held)) {
      const frame = Number(part.fields['x-frame']), blob = new Blob([part.bytes], { type: 'image/jpeg' });
      held = held.slice(part.end);
      jpegs.set(frame, pixels(await createImageBitmap(blob)));
      check(frame);
    }
  }
})().catch(() => {});"""

GREY = """
const c = document.getElementById('canvas');
const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
let most = 0;
for (let i = 0; i < d.length; i += 4) most = Math.max(most, Math.abs(d[i] - d[i + 1]), Math.abs(d[i] - d[i + 2]));
return most < 24;"""


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
    comes_true("the pixel in scene.toml", lambda: abs(focus()["pixel"][0] - 80) < 4 and
               abs(focus()["pixel"][1] - 192) < 4)
    comes_true("the ring", lambda: page.find_elements(By.CSS_SELECTOR, ".handle.focus"))
    for name, text, key in (("focus-distance", "0.5", "distance_m"), ("focus-number", "0.5", "f_number")):
        types(by_id(page, name), text)
        comes_true(f"{key} in scene.toml", lambda: focus().get(key) == 0.5)
    assert "pixel" not in focus(), focus()
    comes_true("a blurred room", lambda: edge_strength(page) < 0.7 * sharp)
    by_id(page, "focus-on").click()
    comes_true("no focus in scene.toml", lambda: not focus())
    comes_true("a sharp room", lambda: edge_strength(page) > 0.9 * sharp)


def freezes(page):
    by_id(page, "freeze").click()
    comes_true("the age over a frozen picture", lambda: "frozen" in by_id(page, "stale").text)
    by_id(page, "freeze").click()
    comes_true("a live picture again", lambda: not by_id(page, "stale").is_displayed())


def two_pages_have_two_views(page, rig):
    """Each its own, kept over a reload, and the program, which one sends and the other follows."""
    def tab(view):
        return page.find_element(By.CSS_SELECTOR, f'[data-view="{view}"]')
    first = page.current_window_handle
    url = page.current_url
    tab("program").click()
    page.switch_to.new_window("window")
    second = page.current_window_handle
    page.get(url)
    comes_true("the second page", lambda: age_ms(page) is not None)
    tab("matte").click()
    comes_true("its own view", lambda: page.execute_script(GREY))
    page.switch_to.window(first)
    assert tab("program").get_attribute("aria-selected") == "true" and tab("matte").get_attribute("aria-selected") == "false"
    comes_true("the program in colour", lambda: age_ms(page) is not None and not page.execute_script(GREY))
    assert rig.state()["view"] == "composite", rig.state()["view"]
    page.switch_to.window(second)
    by_id(page, "to-program").click()
    comes_true("the program", lambda: rig.state()["view"] == "matte")
    page.refresh()
    comes_true("the view after a reload", lambda: tab("matte").get_attribute("aria-selected") == "true")
    page.switch_to.window(first)
    comes_true("the program of both", lambda: tab("program").text == "Program: matte" and page.execute_script(GREY))
    page.switch_to.window(second)
    page.close()
    page.switch_to.window(first)
    tab("composite").click()
    by_id(page, "to-program").click()
    comes_true("the program again", lambda: rig.state()["view"] == "composite")


def says_when_the_rig_is_gone(page, rig):
    assert rig.stop() == 0, rig.text()
    comes_true("the words across the picture", lambda: by_id(page, "lost").is_displayed())
    comes_true("no connection", lambda: "no connection" in by_id(page, "summary").text)
    comes_true("an old picture that says so", lambda: by_id(page, "stale").is_displayed())


def edge_strength(page):
    return page.execute_script(
        "const c = document.getElementById('canvas');"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let sum = 0; for (let i = 4; i < d.length; i += 4) sum += Math.abs(d[i] - d[i - 4]);"
        "return sum / d.length")


def brightness(page):
    return page.execute_script(
        "if (!Picture.frame) return 0;"
        "const c = document.getElementById('canvas');"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let sum = 0; for (let i = 0; i < d.length; i += 4) sum += d[i] + d[i + 1] + d[i + 2];"
        "return 4 * sum / 3 / d.length")
