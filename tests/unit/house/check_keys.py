#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The keys in the tables of docs/reference are those that the code reads, and the other way round.

usage: check_keys.py SOURCE_FOLDER
Keys of the code are the names that getters of config::Table are called with in the files below. Keys of
a page are the names in the first column of each table whose heading begins with "key"; a key of the code
may also stand elsewhere in the page, between backticks.
"""
import pathlib
import re
import sys

CALIBRATION = ["host/capture/calibration_file/tables.cpp"]
READERS = {
    "scene.md": ["host/scene/scene_manifest.cpp", "host/scene/read_camera.cpp", "host/scene/read_outputs.cpp",
                 "host/scene/quality.cpp", "host/pose/mocap/constellation_file.cpp"],
    "rig.md": ["host/capture/live/rig/rig_config.cpp"],
    "take.md": ["host/capture/take/manifest.cpp", "host/calibrate/rig/view_set.cpp"],
    "calibration_file.md": CALIBRATION + ["host/capture/calibration_file/calibration_read.cpp",
                                          "host/capture/calibration_file/lens_table.cpp",
                                          "host/pose/mocap/external.cpp"],
    "room_file.md": ["host/room/scan/room_file.cpp", "host/room/scan/joined_file.cpp",
                     "host/room/background/background_file.cpp", "extras/map/reconstruction/maps/map_file.cpp"],
}
GETTERS = r"(?:has|is_number|size_of|number|number_or|integer|integer_or|boolean_or|text|text_or|one_of|numbers" \
          r"|matrix|table|required_table|tables)"
# table.number("key", ...), and helpers: color_or(table, "key", ...), path_at(root, "key", ...)
READS = [re.compile(r"\." + GETTERS + r"\(\s*\"(\w+)\""), re.compile(r"\(\s*\w+(?:\.\w+\(\"\w+\"\))?,\s*\"(\w+)\"\s*[,)]")]


def keys_of_code(root, files):
    text = "".join((root / file).read_text() for file in files)
    return {key for pattern in READS for key in pattern.findall(text)}


def keys_of_tables(page):
    keys, in_keys, previous = set(), False, ""
    for line in page.splitlines():
        if not line.startswith("|"):
            in_keys = False
        elif not previous.startswith("|"):  # a heading
            in_keys = line.strip("| ").startswith("key")
        elif in_keys:
            for name in re.findall(r"`([^`]+)`", line.split("|")[1]):
                keys.update(name.replace("[]", "").split("."))
        previous = line
    return keys


def main(root):
    failed = False
    for name, files in READERS.items():
        page = (root / "docs" / "reference" / name).read_text()
        read = keys_of_code(root, files)
        # Poses and cameras are tables of several files.
        known = {word for file in files + CALIBRATION for word in re.findall(r"\"(\w+)\"", (root / file).read_text())}
        spans = re.findall(r"`([^`\n]+)`", page) + re.findall(r"^#.*", page, re.M)
        words = {part for span in spans for part in re.split(r"[^\w]+", span)}
        for key in sorted(read - words):
            print(f"docs/reference/{name}: says nothing of \"{key}\", which {', '.join(files)} read")
            failed = True
        for key in sorted(keys_of_tables(page) - known):
            print(f"docs/reference/{name}: \"{key}\" is no key that {', '.join(files)} read")
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
