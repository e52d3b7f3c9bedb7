# SPDX-License-Identifier: Apache-2.0
"""What a run on a take of the studio knew: each input is true, estimated or wrong, by the files that the run used."""
import tomllib

INPUTS = ("poses", "calibration", "lamps", "noise law", "exposure", "ambient", "delay")
WORDS = ("true", "estimated", "wrong")


def read(path):
    with open(path, "rb") as file:
        return tomllib.load(file)


def poses_of(take, scene):
    camera = scene.get("camera", {})
    kind = camera.get("pose", "take")
    if kind == "identity":
        return "wrong"
    return "true" if kind in ("take", "recorded") and "pose" in take and "trajectory" not in camera else "estimated"


def lamps_of(light, studio):
    if light.get("lamps") == "find":
        return "estimated"
    return "true" if light.get("lamp", []) == studio.get("lamp", []) else "wrong"


def inputs_of(take_folder, scene_file, calibration=None):
    """{input: word} of `mixrig run SCENE_FILE --source take:TAKE_FOLDER [--calibration FILE]`. The studio writes what is
    true into take.toml, scene.toml and truth/; a law or a value of the light that the files do not give is a default,
    and wrong. The delay of the depth camera stands in take.toml alone."""
    take, scene = read(take_folder / "take.toml"), read(scene_file)
    light, studio = scene.get("light", {}), read(take_folder / "scene.toml").get("light", {})
    same = lambda key: "true" if key in studio and light.get(key) == studio[key] else "wrong"
    calibration = calibration or scene.get("calibration")
    is_true = calibration is None or take_folder / "truth" in (scene_file.parent / calibration).resolve().parents
    return dict(zip(INPUTS, (
        poses_of(take, scene), "true" if is_true else "estimated", lamps_of(light, studio),
        "true" if "noise" in take.get("depth", {}) else "wrong", same("exposure"), same("ambient"),
        "true")))


def caption(reports):
    """"true: poses, lamps; estimated: calibration" of runs; an input on which they differ has each of its words."""
    texts = []
    for word in WORDS:
        names = [name for name in INPUTS if any(report["inputs"][name] == word for report in reports)]
        if names:
            texts.append(f"{word}: {', '.join(names)}")
    return "; ".join(texts)
