// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D folders and text files, against values worked out by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "host/capture/take/trajectory.h"
#include "host/capture/take/tum_folder.h"
#include "host/math/image_io/image_io.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::take {
namespace {

TEST(Trajectory, LinesAreReadAsTheFormatSays) {
  const auto poses = parse_trajectory(
      "# t x y z qx qy qz qw\n1.5 1 2 3 0 0 0.70710678 0.70710678\r\n\n2.5 0 0 0 0 0 0 1", "p.txt");
  ASSERT_TRUE(poses) << poses.error().context;
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].time_s, 1.5);
  // A quarter turn about z takes x to y.
  EXPECT_TRUE(((*poses)[0].world_from_target * Eigen::Vector3d(1, 0, 0))
                  .isApprox(Eigen::Vector3d(1, 3, 3), 1e-7));
}

TEST(Trajectory, BadLinesAreReportedByNumber) {
  for (const char* bad : {"1 2 3", "1 0 0 0 0 0 0 2", "1 0 0 0 0 0 0 0", "nan 0 0 0 0 0 0 1",
                          "1 inf 0 0 0 0 0 1", "a b c d e f g h"}) {
    const auto poses = parse_trajectory(std::string("# head\n") + bad + "\n", "p.txt");
    ASSERT_FALSE(poses) << bad;
    EXPECT_EQ(poses.error().context.substr(0, 8), "p.txt:2:") << bad;
  }
}

TEST(Trajectory, APoseBetweenTwoIsInterpolatedAndAGapHasNone) {
  const double h = std::sqrt(0.5);
  const std::vector<StampedPose> track{{1.0, {Eigen::Quaterniond(1, 0, 0, 0), {0, 0, 0}}},
                                       {2.0, {Eigen::Quaterniond(h, 0, 0, h), {2, 0, 0}}}};
  const auto middle = pose_at(track, 1.5, 1.0);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->translation_m.x(), 1.0, 1e-12);
  EXPECT_NEAR(2 * std::acos(middle->rotation.w()), M_PI / 4, 1e-9);
  EXPECT_TRUE(pose_at(track, 2.0, 0.1)) << "on a stamp there is no gap";
  EXPECT_FALSE(pose_at(track, 1.5, 0.5));
  EXPECT_FALSE(pose_at(track, 0.9, 9.0));
  EXPECT_FALSE(pose_at(track, 2.1, 9.0));
}

TEST(Associate, ClosestPairsFirstAndEachOnlyOnce) {
  const std::vector<StampedFile> color{{1.00, "a"}, {1.01, "b"}, {2.00, "c"}, {3.00, "d"}};
  const std::vector<StampedFile> depth{{1.012, "A"}, {2.05, "B"}, {3.001, "C"}};
  const auto pairs = associate(color, depth, 0.02);
  EXPECT_EQ(pairs, (std::vector<std::pair<int, int>>{{1, 0}, {3, 2}}));
}

class TumFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("tum/rgb.txt", "# color\n10.00 rgb/a.png\n10.04 rgb/b.png\n10.50 rgb/c.png\n");
    folder_.write("tum/depth.txt", "10.001 depth/a.png\n10.039 depth/b.png\n");
    std::filesystem::create_directories(folder_ / "tum/rgb");
    std::filesystem::create_directories(folder_ / "tum/depth");
    for (const char* name : {"a.png", "b.png"}) {
      ASSERT_TRUE(
          image_io::write_png(folder_ / "tum/rgb" / name, Image<Rgb8>(Size{640, 480}).view()));
      ASSERT_TRUE(image_io::write_png(folder_ / "tum/depth" / name,
                                      Image<std::uint16_t>(Size{640, 480}, 7500).view()));
    }
  }
  test::TemporaryFolder folder_;
};

TEST_F(TumFolder, IsReadAsItIs) {
  auto reader = TakeReader::open(folder_ / "tum");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().frames, 2) << "the third colour picture has no depth";
  EXPECT_EQ(reader->info().target.pinhole, (geometry::Pinhole{{640, 480}, 525, 525, 319.5, 239.5}));
  EXPECT_FALSE(reader->info().has_poses);
  capture::Capture frame;
  ASSERT_TRUE(reader->read(2, frame));
  EXPECT_EQ(frame.time_s, 10.04);
  EXPECT_FLOAT_EQ(frame.depth_m.at(100, 100), 1.5F) << "1/5000 m a step";
}

TEST_F(TumFolder, GroundTruthGivesPosesAndFramesWithoutAreLeftOut) {
  folder_.write("tum/groundtruth.txt", "10.03 1 0 0 0 0 0 1\n10.05 3 0 0 0 0 0 1\n");
  auto reader = TakeReader::open(folder_ / "tum");
  ASSERT_TRUE(reader) << reader.error().context;
  ASSERT_EQ(reader->info().frames, 1);
  capture::Capture frame;
  ASSERT_TRUE(reader->read(1, frame));
  EXPECT_NEAR(frame.world_from_target.translation_m.x(), 2.0, 1e-6);
}

TEST_F(TumFolder, ATakeTomlBesideTheListsBringsItsOwnCalibration) {
  const std::string camera =
      "size_px = [640, 480]\nfx = 517.3\nfy = 516.5\ncx = 318.6\ncy = 255.3\n";
  folder_.write("tum/take.toml",
                "format = 1\n[color]\npath = \"rgb.txt\"\n[depth]\npath = \"depth.txt\"\nunit_m = "
                "0.0002\n[target]\n" +
                    camera + "[tof]\n" + camera +
                    "[target_from_tof]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, "
                    "1]]\ntranslation_m = [0, 0, 0]\n");
  auto reader = TakeReader::open(folder_ / "tum");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().frames, 2);
  EXPECT_EQ(reader->info().target.pinhole.fx_px, 517.3);
}

TEST_F(TumFolder, WithoutAnyPairItIsNoTake) {
  folder_.write("tum/depth.txt", "99 depth/a.png\n");
  EXPECT_TRUE(test::refused(TakeReader::open(folder_ / "tum"),
                            {"rgb.txt: the nearest depth picture is 88.5 s away"},
                            ErrorCode::kFormat));
}

TEST_F(TumFolder, PosesOfAnotherTimeAreNoTake) {
  folder_.write("tum/groundtruth.txt", "99 0 0 0 0 0 0 1\n99.1 0 0 0 0 0 0 1\n");
  EXPECT_TRUE(test::refused(
      TakeReader::open(folder_ / "tum"),
      {"groundtruth.txt: no frame has a pose", "99.000 to 99.100 s", "10.000 to 10.500 s"},
      ErrorCode::kFormat));
}

TEST_F(TumFolder, ItsNominalCameraIsAGuess) {
  auto reader = TakeReader::open(folder_ / "tum");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_TRUE(reader->info().camera_tables.empty()) << "no table says the camera";
  ASSERT_TRUE(image_io::write_png(folder_ / "tum/rgb/a.png", Image<Rgb8>(Size{320, 240}).view()));
  capture::Capture frame;
  EXPECT_TRUE(
      test::refused(reader->read(1, frame), {"rgb/a.png' is 320x240, the assumed camera 640x480",
                                             "has no take.toml: write one with [target]"}));
}

TEST_F(TumFolder, CalibrationTxtSaysTheCamera) {
  const auto camera_of = [&](const char* text) {
    folder_.write("tum/calibration.txt", text);
    auto reader = TakeReader::open(folder_ / "tum");
    EXPECT_TRUE(reader) << reader.error().context;
    return reader ? reader->info().target : geometry::CameraModel();
  };
  const geometry::Pinhole wanted{{640, 480}, 600, 601, 319, 239};
  EXPECT_EQ(camera_of("600.0 601.0 319 239\n").pinhole, wanted);
  EXPECT_EQ(camera_of("# fx fy cx cy\n600, 601, 319, 239").pinhole, wanted);
  EXPECT_EQ(camera_of("600 0 319\n0 601 239\n0 0 1\n").pinhole, wanted);
  const geometry::CameraModel bent = camera_of("600 601 319 239 0.1 -0.05 0.001 -0.002 0.01\n");
  EXPECT_EQ(bent.pinhole, wanted);
  EXPECT_EQ(bent.lens.coefficients()[0], 0.1);
  EXPECT_EQ(bent.lens.coefficients()[3], -0.002);
  EXPECT_EQ(bent.lens.coefficients()[4], 0.01);
  for (const char* bad : {"600 601 319", "fx 600 fy 601 cx 319 cy 239", "-600 601 319 239", ""}) {
    folder_.write("tum/calibration.txt", bad);
    EXPECT_TRUE(test::refused(TakeReader::open(folder_ / "tum"), {"tum/calibration.txt: "},
                              ErrorCode::kFormat))
        << bad;
  }
}

/// Of other pictures than the Kinect's, whose size a file of numbers does not say.
TEST_F(TumFolder, TheSizeOfItsCameraIsThatOfItsPictures) {
  folder_.write("tum/calibration.txt", "300 300 159.5 119.5\n");
  for (const char* name : {"a.png", "b.png"}) {
    ASSERT_TRUE(
        image_io::write_png(folder_ / "tum/rgb" / name, Image<Rgb8>(Size{320, 240}).view()));
    ASSERT_TRUE(image_io::write_png(folder_ / "tum/depth" / name,
                                    Image<std::uint16_t>(Size{320, 240}, 7500).view()));
  }
  auto reader = TakeReader::open(folder_ / "tum");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().target.size_px(), (Size{320, 240}));
  EXPECT_EQ(reader->info().tof.size_px(), (Size{320, 240}));
  capture::Capture frame;
  EXPECT_TRUE(reader->read(1, frame));
}

}  // namespace
}  // namespace mixrig::take
