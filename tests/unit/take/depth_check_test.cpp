// SPDX-License-Identifier: Apache-2.0
// Depth that cannot be what the take says: steps that mean nothing, 8 bits, a wrong unit.
#include "host/capture/take/streams/depth_check.h"

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

constexpr Size kSize{40, 30};

/// Lines about one picture of these steps.
std::vector<std::string> found_in(const Image<std::uint16_t>& picture, const Steps& meaning) {
  DepthCheck check("t: [depth]");
  Image<float> depth_m;
  from_steps(picture, meaning, depth_m);
  check.look(picture, meaning, depth_m);
  return check.found();
}

/// A wall that falls from 2 to 3 m, of which `part` has another step.
Image<std::uint16_t> wall(double part = 0, int step = 0) {
  Image<std::uint16_t> picture(kSize);
  int number = 0;
  for (const auto [x, y] : test::each_pixel(kSize)) {
    const bool other = number++ < part * kSize.width * kSize.height;
    picture.at(x, y) = static_cast<std::uint16_t>(other ? step : 2000 + 25 * x);
  }
  return picture;
}

TEST(DepthCheck, AMeasuredWallIsSound) {
  EXPECT_TRUE(found_in(wall(), {.unit = 0.001}).empty());
  EXPECT_TRUE(found_in(wall(0.4, 0), {.unit = 0.001}).empty());
}

TEST(DepthCheck, AStepOfOnesFarFromAllOthersIsNamed) {
  for (const int step : {65535, 32767, 8191}) {
    const auto lines = found_in(wall(0.3, step), {.unit = 0.001});
    ASSERT_EQ(lines.size(), 1U) << step;
    EXPECT_NE(lines[0].find("t: [depth]: 30 % of a picture are step " + std::to_string(step)),
              std::string::npos)
        << lines[0];
    EXPECT_NE(lines[0].find("unknown = [0, " + std::to_string(step) + "]"), std::string::npos);
    EXPECT_TRUE(found_in(wall(0.3, step), {.unit = 0.001, .unknown = {0, step, -1, -1}}).empty())
        << "it is stated";
  }
  EXPECT_TRUE(found_in(wall(0.001, 65535), {.unit = 0.001}).empty()) << "one pixel of a thousand";
  EXPECT_TRUE(found_in(wall(0.3, 5000), {.unit = 0.001}).empty())
      << "a wall parallel to the picture";
}

TEST(DepthCheck, AWrongUnitIsToldByWhereTheDepthLies) {
  const auto near = found_in(wall(), {.unit = 0.00006});
  ASSERT_EQ(near.size(), 1U);
  EXPECT_NE(near[0].find("nearer than 0.25 m (median 0.15 m)"), std::string::npos) << near[0];
  const auto far = found_in(wall(), {.unit = 0.01});
  ASSERT_EQ(far.size(), 1U);
  EXPECT_NE(far[0].find("farther than 15 m (median 24.8 m)"), std::string::npos) << far[0];
}

TEST(DepthCheck, APictureOf8BitsMadeTo16IsTold) {
  Image<std::uint16_t> picture(kSize);
  for (const auto [x, y] : test::each_pixel(kSize))
    picture.at(x, y) = static_cast<std::uint16_t>(257 * (8 + x / 2));
  const auto lines = found_in(picture, {.unit = 0.001});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("multiples of 257"), std::string::npos) << lines[0];
}

TEST(DepthCheck, EachFaultIsToldOnceAndLaterPicturesAreNotLookedAt) {
  DepthCheck check("again: [depth]");
  Image<float> near(kSize, 0.1F);
  int looks = 0;
  for (; check.wants_more(); ++looks) check.look(near);
  EXPECT_EQ(looks, 5);
  EXPECT_EQ(check.found().size(), 1U);
}

/// Another share of step 65535 in each picture, and a median that it makes: one line.
TEST(DepthCheck, OneFaultOfManyPicturesIsOneLine) {
  DepthCheck check("many: [depth]");
  for (const double part : {0.6, 0.7, 0.8}) {
    const Image<std::uint16_t> picture = wall(part, 65535);
    Image<float> depth_m;
    from_steps(picture, {.unit = 0.001}, depth_m);
    check.look(picture, {.unit = 0.001}, depth_m);
  }
  ASSERT_EQ(check.found().size(), 1U);
  EXPECT_NE(check.found()[0].find("60 % of a picture are step 65535"), std::string::npos);
}

/// A take of one frame whose depth picture is `depth`.
class DepthTake : public ::testing::Test {
 protected:
  Result<TakeReader> open(const std::string& keys) {
    std::filesystem::create_directories(folder_ / "color");
    std::filesystem::create_directories(folder_ / "depth");
    EXPECT_TRUE(image_io::write_png(folder_ / "color/1.png", Image<Rgb8>(kSize).view()));
    const std::string camera = "size_px = [40, 30]\nfx = 60\nfy = 60\ncx = 20\ncy = 15\n";
    const std::string pose = "rotation_xyzw = [0, 0, 0, 1]\ntranslation_m = [0, 0, 0]\n";
    folder_.write("take.toml",
                  "format = 1\n[color]\npath = \"color/%d.png\"\ncount = 1\n[depth]\npath = "
                  "\"depth/%d.png\"\ncount = 1\n" +
                      keys + "[target]\n" + camera + "[tof]\n" + camera + "[target_from_tof]\n" +
                      pose + "[depth2]\npath = \"depth/%d.png\"\ncount = 1\n" + keys + "[tof2]\n" +
                      camera + "[target_from_tof2]\n" + pose);
    return TakeReader::open(folder_.path());
  }
  test::TemporaryFolder folder_;
};

TEST_F(DepthTake, SeveralStepsMayMeanNoMeasurement) {
  auto reader = open("unknown = [0, 65535, 2000]\n");
  ASSERT_TRUE(reader) << reader.error().context;
  const Image<std::uint16_t> picture = wall(0.25, 65535);
  ASSERT_TRUE(image_io::write_png(folder_ / "depth/1.png", picture.view()));
  capture::Capture frame;
  ASSERT_TRUE(reader->read(1, frame));
  for (const Image<float>* depth_m : {&frame.depth_m, &frame.depth2.depth_m}) {
    EXPECT_EQ(depth_m->at(3, 0), 0) << "65535";
    EXPECT_EQ(depth_m->at(0, 29), 0) << "2000";
    EXPECT_FLOAT_EQ(depth_m->at(1, 29), 2.025F);
  }
}

TEST_F(DepthTake, WrongUnknownStepsAreNamed) {
  EXPECT_TRUE(test::refused(open("unknown = [0, 1.5]\n"), {"depth.unknown", "whole steps"}));
  EXPECT_TRUE(test::refused(open("unknown = [0, 70000]\n"), {"depth.unknown", "70000"}));
  EXPECT_TRUE(test::refused(open("unknown = [0, 1, 2, 3, 4]\n"), {"depth.unknown", "1 to 4"}));
}

TEST_F(DepthTake, DepthOf8BitsIsRefused) {
  auto reader = open("");
  ASSERT_TRUE(reader) << reader.error().context;
  ASSERT_TRUE(image_io::write_png(folder_ / "depth/1.png", Image<std::uint8_t>(kSize, 140).view()));
  capture::Capture frame;
  EXPECT_TRUE(test::refused(reader->read(1, frame),
                            {"depth/1.png' has 8 bits a pixel: depth needs 16"},
                            ErrorCode::kFormat));
}

TEST_F(DepthTake, ColourAsDepthIsRefused) {
  auto reader = open("");
  ASSERT_TRUE(reader);
  ASSERT_TRUE(image_io::write_png(folder_ / "depth/1.png", Image<Rgb8>(kSize).view()));
  capture::Capture frame;
  EXPECT_TRUE(test::refused(reader->read(1, frame), {"depth/1.png", "16"}, ErrorCode::kFormat));
}

}  // namespace
}  // namespace mixrig::take
