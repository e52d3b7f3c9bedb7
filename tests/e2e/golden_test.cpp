// SPDX-License-Identifier: Apache-2.0
// Compares a whole composite with a stored one, which finds changes that no measure shows. The
// stored picture was inspected by eye; after an intended change, make it again with the two
// commands below.
#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"
#include "tests/support/psnr.h"

namespace mixrig::test {
namespace {

class Golden : public CommandTest {};

TEST_F(Golden, TheCompositeIsUnchanged) {
  ASSERT_EQ(
      studio("take", "--plain --scenario walk --rig kinect2 --seed 5 --frames 12 --size 320x256"),
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
