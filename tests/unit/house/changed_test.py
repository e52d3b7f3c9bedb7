#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Of tests/changed.py: a change concerns the tests downstream of it and no others."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2]))
import changed

ROOMS = "base|hal/base|fmt::fmt|\nrender|host/render|mixrig::base|\ncpu|host/render/cpu|mixrig::render|fmt::fmt\nplan|extras/people/plan|mixrig::base|\n"
PROGRAMS = ("render_test|mixrig::cpu;GTest::gtest|tests/unit/render\nroom_test|mixrig::plan|tests/unit/plan;tests/unit/room\n"
            "hal_test|mixrig::base|tests/unit/base\n")


class Changed(unittest.TestCase):
    def concerned(self, *files):
        with tempfile.TemporaryDirectory() as folder:
            build = pathlib.Path(folder)
            (build / "modules.txt").write_text(ROOMS)
            (build / "test_programs.txt").write_text(PROGRAMS)
            return changed.concerned(build, files)

    def test_a_module_concerns_what_links_it_at_whatever_distance(self):
        self.assertEqual(self.concerned("host/render/cpu/mix/mix.cpp"), {"house", "render_test"})
        self.assertEqual(self.concerned("host/render/inner/x.h"), {"house", "render_test"})
        self.assertEqual(self.concerned("hal/base/image.h"), {"house", "render_test", "room_test", "hal_test"})

    def test_a_test_file_concerns_its_program_alone(self):
        self.assertEqual(self.concerned("tests/unit/room/a_test.cpp"), {"house", "room_test"})

    def test_text_concerns_nothing_and_other_files_everything(self):
        self.assertEqual(self.concerned("README.md", "docs/a.svg", "extras/people/plan/README.md"), {"house"})
        self.assertIsNone(self.concerned("README.md", "cmake/MixrigRoom.cmake"))
        self.assertIsNone(self.concerned("tests/support/seeds.h"))


if __name__ == "__main__":
    unittest.main()
