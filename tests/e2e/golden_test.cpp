// SPDX-License-Identifier: Apache-2.0
// A whole composite against a kept one: what no single measure would notice. The kept picture was
// looked at; make it again with the two commands below after a change that is meant.
#include <cmath>

#include <gtest/gtest.h>

#include "host/image_io/image_io.h"
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class Golden : public CommandTest {};

double psnr_db(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const Rgb8 p = a.at(x, y), q = b.at(x, y);
      for (const int d : {p.r - q.r, p.g - q.g, p.b - q.b}) sum += d * d;
    }
  const double mean = sum / (3.0 * static_cast<double>(a.size().area()));
  return mean > 0 ? 10 * std::log10(255.0 * 255.0 / mean) : 100;
}

TEST_F(Golden, TheCompositeLooksAsItDid) {
  ASSERT_EQ(mixrig("studio " + path("take") +
                   " --scenario walk --rig kinect2 --seed 5 --frames 12 --size 320x256"),
            0);
  ASSERT_EQ(mixrig("run " + path("take/scene.toml") + " --source take:" + path("take") + " --out " +
                   path("out") + " --backend cpu"),
            0);
  Image<Rgb8> now, kept;
  ASSERT_TRUE(image_io::read_rgb8(path("out/composite/color/000006.png"), now));
  const char* source = std::getenv("MIXRIG_SOURCE");
  ASSERT_NE(source, nullptr);
  ASSERT_TRUE(image_io::read_rgb8(std::string(source) + "/tests/golden/walk_5_frame_12.png", kept));
  ASSERT_EQ(now.size(), kept.size());
  EXPECT_GE(psnr_db(now, kept), 42.0);
}

}  // namespace
}  // namespace mixrig::test
