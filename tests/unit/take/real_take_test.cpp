// SPDX-License-Identifier: Apache-2.0
// Reads the recordings that tests/data describes from where they are stored (label data).
#include <cstdlib>

#include <gtest/gtest.h>

#include "host/capture/take/take.h"

namespace mixrig::take {
namespace {

struct Row {
  const char* name;
  int frames;
  int last_readable;  ///< read as well as the first
};

class RealTake : public ::testing::TestWithParam<Row> {};

TEST_P(RealTake, OpensAndHoldsPlausibleDepth) {
  if (std::getenv("MIXRIG_DATA") == nullptr)
    GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
  const std::string source =
      std::getenv("MIXRIG_SOURCE") != nullptr ? std::getenv("MIXRIG_SOURCE") : ".";
  auto reader = TakeReader::open(source + "/tests/data/" + GetParam().name);
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().frames, GetParam().frames);
  capture::Capture frame;
  for (const int number : {1, GetParam().last_readable}) {
    const auto read = reader->read(number, frame);
    ASSERT_TRUE(read) << read.error().context;
    int known = 0, plausible = 0;
    for (int y = 0; y < frame.depth_m.height(); ++y)
      for (int x = 0; x < frame.depth_m.width(); ++x) {
        const float z_m = frame.depth_m.at(x, y);
        known += z_m != 0.0F ? 1 : 0;
        plausible += z_m > 0.1F && z_m < 20.0F ? 1 : 0;
      }
    EXPECT_GT(known, static_cast<int>(frame.depth_m.size().area() / 5));
    EXPECT_GE(plausible, known * 99 / 100);
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, RealTake,
                         ::testing::Values(Row{"lab_queue", 108, 108},
                                           Row{"azure_kinect_raw", 1, 1},
                                           Row{"kinect1_turntable", 50, 50}),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace mixrig::take
