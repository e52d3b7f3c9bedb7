#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The captions of the results say what a run knew, by the files that it used."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "docs/results"))
from inputs import caption, inputs_of  # noqa: E402

TAKE = '[depth]\nnoise = [0.001, 0.002, 0.0]\ndelay_ms = 6.0\n[pose]\nfile = "poses.txt"\n'
SCENE = ('[camera]\npose = "take"\n[light]\nexposure = 1.1\nambient = [0.1, 0.1, 0.1]\n'
         '[[light.lamp]]\nname = "a"\nposition_m = [1.0, 2.0, 3.0]\nintensity = 2.0\n')


class Inputs(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.take = pathlib.Path(kept.name).resolve() / "take"
        self.take.mkdir()
        (self.take / "take.toml").write_text(TAKE)
        (self.take / "scene.toml").write_text(SCENE)

    def of(self, old="", new="", calibration=None, of_take=("", "")):
        scene = self.take / "mine.toml"
        scene.write_text(SCENE.replace(old, new) if old else SCENE)
        (self.take / "take.toml").write_text(TAKE.replace(*of_take) if of_take[0] else TAKE)
        return caption([{"inputs": inputs_of(self.take, scene, calibration)}])

    def test_the_studios_own_files_are_true(self):
        self.assertEqual(self.of(), "true: poses, calibration, lamps, noise law, exposure, ambient, delay")

    def test_each_change_is_seen(self):
        for name, word, change in (
                ("lamps", "wrong", {"old": "[1.0, 2.0, 3.0]", "new": "[1.3, 2.0, 3.0]"}),
                ("lamps", "wrong", {"old": "intensity = 2.0", "new": "intensity = 2.6"}),
                ("exposure", "wrong", {"old": "exposure = 1.1", "new": "exposure = 1.3"}),
                ("ambient", "wrong", {"old": "ambient = [0.1, 0.1, 0.1]\n", "new": ""}),
                ("poses", "estimated", {"old": '"take"', "new": '"tracker"'}),
                ("poses", "estimated", {"old": '"take"', "new": '"recorded"\ntrajectory = "mine.txt"'}),
                ("poses", "wrong", {"old": '"take"', "new": '"identity"'}),
                ("calibration", "estimated", {"calibration": "/elsewhere/calibration.toml"}),
                ("noise law", "wrong", {"of_take": ("noise = [0.001, 0.002, 0.0]\n", "")})):
            text = self.of(**change)
            self.assertTrue(text.endswith(f"; {word}: {name}"), (change, text))
            self.assertNotIn(name, text.split("; ")[0])

    def test_lamps_that_are_found_are_estimated(self):
        found = SCENE[:SCENE.index("[[light.lamp]]")] + 'lamps = "find"\n'
        self.assertIn("estimated: lamps", self.of(SCENE, found))

    def test_the_true_calibration_of_a_take_is_true(self):
        self.assertNotIn("estimated", self.of(calibration=self.take / "truth/calibration.toml"))

    def test_runs_that_differ_have_both_words(self):
        own = inputs_of(self.take, self.take / "scene.toml")
        text = caption([{"inputs": own}, {"inputs": dict(own, lamps="wrong")}])
        self.assertTrue(text.endswith("; wrong: lamps") and "lamps" in text.split("; ")[0], text)


if __name__ == "__main__":
    unittest.main()
