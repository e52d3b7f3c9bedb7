// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on a real recording (label data): people enter and leave a room.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RealRun : public CommandTest {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
  }
  const std::string lab_ =
      std::string(std::getenv("MIXRIG_SOURCE") ? std::getenv("MIXRIG_SOURCE") : ".") +
      "/tests/data/lab_queue";
};

TEST_F(RealRun, EmptyFramesOfTheLabKeyNothingAndPeopleAreKeyed) {
  ASSERT_EQ(mixrig("scan --static " + lab_ + "/take.toml --frames 1-26 " + path("background")), 0);
  ASSERT_EQ(mixrig("run " + lab_ + "/scene.toml --source take:" + lab_ + "/take.toml --out " +
                   path("out") + " --backend cpu --format none --json " + path("report.json")),
            0);
  const std::vector<double> foreground_pct = column(path("out") + "/frames.csv", 4);
  ASSERT_EQ(foreground_pct.size(), 108U - 26U);
  EXPECT_EQ(report("report.json").at("frames"), 108 - 26);
  for (int frame = 103; frame <= 108; ++frame)
    EXPECT_LE(foreground_pct[static_cast<std::size_t>(frame - 27)], 0.1)
        << "frame " << frame << " is empty";
  EXPECT_GE(*std::max_element(foreground_pct.begin(), foreground_pct.end()), 15.0);
}

/// Both lamps over the aisle are hidden from the floor below the car: 131 x 21 pixels of it.
TEST_F(RealRun, TheShadowOnTheFloorOfTheLabIsSmooth) {
  for (const std::string backend : {"cpu", "gles"}) {
    ASSERT_EQ(mixrig("run " + lab_ + "/scene.toml --source take:" + lab_ + "/take.toml --out " +
                     path("out") + " --frames 103-103 --inspect --backend " + backend),
              0);
    Image<Rgb8> light;
    ASSERT_TRUE(image_io::read_rgb8(path("out/light/000001.png"), light));
    double sum = 0, squares = 0, brightest = 0;
    int count = 0;
    for (int y = 320; y <= 340; ++y)
      for (int x = 105; x <= 235; ++x, ++count) {
        const double value = linear_of_srgb_bytes()[light.row(y)[x].r];
        sum += value, squares += value * value;
        brightest = std::max(brightest, value);
      }
    const double mean = sum / count;
    EXPECT_LE(std::sqrt(squares / count - mean * mean), 0.03) << backend;
    EXPECT_LT(brightest, 0.5) << backend << ": holes";
  }
}

}  // namespace
}  // namespace mixrig::test
