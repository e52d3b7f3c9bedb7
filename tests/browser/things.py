# SPDX-License-Identifier: Apache-2.0
"""Objects and lamps on the page: what is done there is in scene.toml."""
import json
import shutil
import urllib.request

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from rig import by_id, comes_true, field


def drags_an_object(page, rig):
    thing = comes_true("an object in the picture", lambda: next(o for o in rig.state()["objects"] if o["at"]))
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
    field(page, "remove", "new thing").click()
    comes_true("the object is gone", lambda: len(rig.scene()["object"]) == count)
    comes_true("the run knows", lambda: len(rig.state()["objects"]) == count)


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
    field(page, "remove", lamps[-1]["name"]).click()
    comes_true("the lamp is gone", lambda: len(rig.scene()["light"]["lamp"]) == len(lamps) - 1)


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
