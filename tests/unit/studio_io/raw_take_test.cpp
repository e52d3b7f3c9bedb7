// SPDX-License-Identifier: Apache-2.0
// The studio's raw pictures become depth through a take, which is compared with the studio's truth.
#include <fstream>

#include <gtest/gtest.h>

#include "host/capture/take/take_source.h"
#include "host/math/image_io/image_io.h"
#include "studio/io/studio_take.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::studio_io {
namespace {

studio::StudioOptions raw_options() {
  studio::StudioOptions options;
  options.seed = 7, options.frames = 3, options.size_px = {64, 52}, options.raw = true;
  return options;
}

TEST(RawTake, DecodesToTheTrueDistances) {
  const test::TemporaryFolder folder;
  const auto take = folder.path() / "take";
  ASSERT_TRUE(write_studio_take(raw_options(), take, take::StreamFormat::kPng, [](int) {}));
  const auto source = take::open_take_source(take);
  ASSERT_TRUE(source) << to_line(source.error());
  EXPECT_EQ((*source)->info().depth_kind, capture::DepthKind::kDistance);
  EXPECT_TRUE((*source)->info().amplitude_is_light);
  capture::Capture frame;
  ASSERT_TRUE((*source)->read(3, frame));  // with a person
  Image<std::uint16_t> truth;
  ASSERT_TRUE(image_io::read_gray16(take / "truth/tof_distance/000003.png", truth));
  long known = 0, wrong = 0, pixels = 0;
  double bias = 0, square = 0;
  for (int y = 1; y < 423; ++y)
    for (int x = 1; x < 511; ++x) {
      if (truth.at(x, y) == 0) continue;
      ++pixels;
      if (!(frame.depth_m.at(x, y) > 0)) continue;
      const double e = static_cast<double>(frame.depth_m.at(x, y)) - truth.at(x, y) / 4000.0;
      if (std::abs(e) > 0.1) {
        ++wrong;
        continue;
      }
      ++known, bias += e, square += e * e;
    }
  EXPECT_GT(pixels, 200000);
  EXPECT_GT(static_cast<double>(known) / static_cast<double>(pixels), 0.975);
  EXPECT_LT(static_cast<double>(wrong) / static_cast<double>(pixels), 0.003);
  EXPECT_LT(std::abs(bias / static_cast<double>(known)), 0.001);
  EXPECT_LT(std::sqrt(square / static_cast<double>(known)), 0.009);
  EXPECT_FALSE(frame.amplitude.empty());
}

TEST(RawTake, FilesThatAreDamagedAreNamed) {
  const test::TemporaryFolder folder;
  const auto take = folder.path() / "take";
  ASSERT_TRUE(write_studio_take(raw_options(), take, take::StreamFormat::kPng, [](int) {}));
  std::filesystem::resize_file(take / "raw/000002.bin", 2000000);
  const auto source = take::open_take_source(take);
  ASSERT_TRUE(source);
  capture::Capture frame;
  const auto read = (*source)->read(2, frame);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().context.find("raw/000002.bin"), std::string::npos);
  std::filesystem::resize_file(take / "raw/phase_offsets.bin", 100);
  const auto again = take::open_take_source(take);
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().context.find("phase_offsets.bin"), std::string::npos);
}

TEST(RawTake, OnlyTheKinect2HasRawPictures) {
  studio::StudioOptions options = raw_options();
  options.rig = studio::RigPreset::kSr3000;
  const auto studio = studio::Studio::create(options);
  ASSERT_FALSE(studio);
  EXPECT_NE(studio.error().context.find("--rig kinect2"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::studio_io
