// SPDX-License-Identifier: Apache-2.0
#include "host/capture/calibration_file/choice.h"

#include <gtest/gtest.h>

namespace mixrig::calibration_file {
namespace {

using Origin = CalibrationOrigin;

struct Case {
  CalibrationCandidates candidates;
  Origin origin;
  const char *file, *where, *why;
};

TEST(ChooseCalibration, ByPrecedenceWithTheReason) {
  const std::vector<std::string> tables{"target", "tof"};
  const Case cases[] = {
      {{.option = "o.toml",
        .scene = "s.toml",
        .source = "r.toml",
        .inline_tables = tables,
        .reported = true,
        .scene_file = "scene.toml",
        .source_file = "rig.toml"},
       Origin::kFile,
       "o.toml",
       "o.toml",
       "named by --calibration; not used: scene.toml names s.toml, rig.toml names r.toml, "
       "[target], [tof] of rig.toml, what the devices report"},
      {{.option = "", .scene = "s.toml", .source = "r.toml", .source_file = "rig.toml"},
       Origin::kFile,
       "s.toml",
       "s.toml",
       "named by scene.toml; not used: rig.toml names r.toml"},
      {{.option = "", .scene = "", .source = "t/c.toml", .inline_tables = tables},
       Origin::kFile,
       "t/c.toml",
       "t/c.toml",
       "named by take.toml; not used: [target], [tof] of take.toml"},
      {{.option = "",
        .scene = "",
        .source = "",
        .inline_tables = tables,
        .reported = true,
        .source_file = "rig.toml"},
       Origin::kInlineTables,
       "",
       "[target], [tof] of rig.toml",
       "no calibration.toml is named; not used: what the devices report"},
      {{.option = "", .scene = "", .source = "", .reported = true, .source_file = "rig.toml"},
       Origin::kDevices,
       "",
       "the devices",
       "no calibration.toml is named, rig.toml has no table of a camera"},
      {{},
       Origin::kGuess,
       "",
       "a guess",
       "no calibration is given and the devices report none: run mixrig calibrate"},
  };
  for (const Case& c : cases) {
    const CalibrationChoice choice = choose_calibration(c.candidates);
    EXPECT_EQ(choice.origin, c.origin) << c.where;
    EXPECT_EQ(choice.file, c.file);
    EXPECT_EQ(choice.where, c.where);
    EXPECT_EQ(choice.why, c.why);
  }
}

}  // namespace
}  // namespace mixrig::calibration_file
