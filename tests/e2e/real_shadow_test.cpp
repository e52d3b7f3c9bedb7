// SPDX-License-Identifier: Apache-2.0
// The shadow of a virtual car on the floor of a real recording, drawn by both back ends.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RealShadow : public CommandTest {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
  }
  const std::string lab_ =
      std::string(std::getenv("MIXRIG_SOURCE") ? std::getenv("MIXRIG_SOURCE") : ".") +
      "/tests/data/lab_queue";
};

/// Both lamps over the aisle are hidden from 131 x 21 pixels of the floor below the car.
TEST_F(RealShadow, OnTheFloorOfTheLabIsSmooth) {
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
