# SPDX-License-Identifier: Apache-2.0
"""The page in another language than English."""
import re

from rig import By, by_id, comes_true, has_names, presses

# What the rig itself says, or a person wrote, is not translated.
NOT_OF_THE_PAGE = "#log, #background, #scan-state, #sweep-state, #record-state, #health dd, #streams"
ENGLISH = re.compile(r"\b(the|of|is|and|to|with|not|frames?|picture|take|name|record|lamp|left|off)\b", re.I)
TEXTS = """
  const texts = [];
  for (const node of document.body.querySelectorAll('*')) {
    if (node.closest(arguments[0])) continue;
    texts.push(...['aria-label', 'title', 'placeholder', 'alt'].map(name => node.getAttribute(name)).filter(Boolean));
    texts.push(...[...node.childNodes].filter(child => child.nodeType === 3).map(child => child.data.trim()));
  }
  return texts.filter(Boolean);
"""


def speaks_german(page, rig):
    """By the address, and by the browser's languages; no English word is left, and edits and keys work as ever."""
    page.get(rig.url + "?lang=de")
    comes_true("the state", lambda: by_id(page, "tally").text == "keine Aufnahme")
    assert page.execute_script("return document.documentElement.lang") == "de"
    comes_true("the takes", lambda: "Bilder" in by_id(page, "takes").text)
    name = rig.scene()["object"][0]["name"]
    hide = comes_true("a control", lambda: page.find_elements(By.CSS_SELECTOR, f'[aria-label="Ausblenden von {name}"]'))[0]
    hide.click()
    comes_true("the edit", lambda: rig.object(name).get("hidden"))
    comes_true("the button", lambda: by_id(page, "undo").get_attribute("title").startswith("Rückgängig: hide"))
    by_id(page, "undo").click()
    comes_true("undone", lambda: not rig.object(name).get("hidden") and "Rückgängig gemacht" in by_id(page, "message").text)
    presses(page, "m")
    has_names(page)
    own = [name, *(lamp["name"] for lamp in rig.scene()["light"]["lamp"]), *(take["name"] for take in rig.state()["takes"]),
           "hide", "Takes", "Take", "Name"]
    left = []
    for text in page.execute_script(TEXTS, NOT_OF_THE_PAGE):
        rest = re.sub("|".join([r"take \d+", *map(re.escape, sorted(own, key=len, reverse=True))]), "", text)
        if ENGLISH.search(rest):
            left.append(text)
    assert not left, left
    page.execute_cdp_cmd("Emulation.setUserAgentOverride", {"userAgent": page.execute_script("return navigator.userAgent"),
                                                            "acceptLanguage": "fr-CH,de-AT,en"})
    page.get(rig.url)
    comes_true("German by the browser", lambda: by_id(page, "tally").text == "keine Aufnahme")
    page.execute_cdp_cmd("Emulation.setUserAgentOverride", {"userAgent": page.execute_script("return navigator.userAgent"),
                                                            "acceptLanguage": "en-GB"})
    page.get(rig.url)
    comes_true("English again", lambda: by_id(page, "tally").text == "not recording")
    print("in German: no English word is left")
