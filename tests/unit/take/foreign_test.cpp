// SPDX-License-Identifier: Apache-2.0
// Recordings of other programs as takes, against what other readers say of them: ffprobe and the
// parameters in azure-kinect-raw/README.md; tiny.bag, which tests/data/foreign/make_bag.py writes;
// folders made here by what the data sets publish.
#include <cstdlib>

#include <gtest/gtest.h>

#include "host/capture/take/foreign/import.h"
#include "host/math/image_io/image_io.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::take {
namespace {

namespace fs = std::filesystem;

void expect_camera(const geometry::CameraModel& camera, const geometry::Pinhole& pinhole,
                   const geometry::Lens::Coefficients& lens, double tolerance_px) {
  EXPECT_EQ(camera.size_px(), pinhole.size_px);
  EXPECT_NEAR(camera.pinhole.fx_px, pinhole.fx_px, tolerance_px);
  EXPECT_NEAR(camera.pinhole.fy_px, pinhole.fy_px, tolerance_px);
  EXPECT_NEAR(camera.pinhole.cx_px, pinhole.cx_px, tolerance_px);
  EXPECT_NEAR(camera.pinhole.cy_px, pinhole.cy_px, tolerance_px);
  for (std::size_t i = 0; i < lens.size(); ++i)
    EXPECT_NEAR(camera.lens.coefficients()[i], lens[i], 1e-9) << i;
}

class Foreign : public ::testing::Test {
 protected:
  static fs::path tiny_bag() {
    const char* source = std::getenv("MIXRIG_SOURCE");
    return fs::path(source != nullptr ? source : ".") / "tests/data/foreign/tiny.bag";
  }
  Result<TakeReader> imported(const fs::path& source) {
    auto made = import_recording(source, folder_ / "take");
    if (!made) return made.error();
    told_ = *made;
    return TakeReader::open(folder_ / "take");
  }
  void write_frame(const fs::path& color, const fs::path& depth, std::uint16_t step) {
    fs::create_directories(color.parent_path());
    fs::create_directories(depth.parent_path());
    Image<std::uint16_t> steps(Size{32, 24}, step);
    steps.row(0)[0] = 65535;
    ASSERT_TRUE(image_io::write_png(color, Image<Rgb8>(Size{64, 48}, {9, 8, 7}).view()));
    ASSERT_TRUE(image_io::write_png(depth, steps.view()));
  }
  test::TemporaryFolder folder_;
  Imported told_;
};

TEST_F(Foreign, ARecordingOfAnAzureKinectKeepsItsPicturesTimesAndCalibration) {
  const char* data = std::getenv("MIXRIG_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs recordings: set MIXRIG_DATA";
  const fs::path folder = fs::path(data) / "azure-kinect-raw";
  auto take = imported(folder / "recording.mkv");
  ASSERT_TRUE(take) << take.error().context;
  EXPECT_EQ(told_.color, 1);
  EXPECT_EQ(told_.depth, 1) << "as ffprobe -count_frames says";
  EXPECT_EQ(test::read_bytes(folder_ / "take/color/000001.jpg"),
            test::read_bytes(folder / "color_0.jpg"));
  EXPECT_NE(test::read_bytes(folder_ / "take/rgb.txt").find("\n0.463945 color/000001.jpg"),
            std::string::npos)
      << "the start that ffprobe says";
  const TakeInfo& info = take->info();
  expect_camera(
      info.target, {{1280, 720}, 611.7953491, 611.9269752, 639.3043441, 365.8529014},
      {0.33012130856513977, -2.489396572113037, -0.00016178244550246745, -0.00012944525224156678,
       1.453670859336853, 0.20891207456588745, -2.302915096282959, 1.3751275539398193},
      1e-4);
  expect_camera(
      info.tof, {{640, 576}, 504.6076354, 504.7325134, 332.7810668, 348.8297119},
      {0.5479397773742676, -0.020971370860934258, 2.0557534298859537e-05, -7.210415787994862e-05,
       -0.002652231603860855, 0.8896790742874146, 0.08613020926713943, -0.013910384848713875},
      1e-4);
  EXPECT_NEAR(info.target_from_tof.translation_m.x(), -0.032083429, 1e-8);
  EXPECT_NEAR(info.target_from_tof.rotation.toRotationMatrix()(1, 2), 0.0861603245, 1e-8);
  Image<std::uint16_t> ours, theirs;
  ASSERT_TRUE(image_io::read_gray16(folder_ / "take/depth/000001.png", ours));
  ASSERT_TRUE(image_io::read_gray16(folder / "depth_0.png", theirs));
  ASSERT_EQ(ours.size(), theirs.size());
  for (int y = 0; y < ours.height(); ++y)
    ASSERT_TRUE(std::equal(ours.row(y), ours.row(y) + ours.width(), theirs.row(y))) << y;
}

TEST_F(Foreign, ABagIsReadByWhatItsTopicsHold) {
  auto take = imported(tiny_bag());
  ASSERT_TRUE(take) << take.error().context;
  EXPECT_EQ(told_.color, 3);
  EXPECT_EQ(told_.depth, 2);
  EXPECT_EQ(told_.frames, 2);
  ASSERT_EQ(told_.lost.size(), 2U) << "infrared, and colour without depth";
  EXPECT_NE(told_.lost[0].find("/cam/infra/image_raw"), std::string::npos) << told_.lost[0];
  const TakeInfo& info = take->info();
  expect_camera(info.target, {{32, 24}, 30.5, 31.5, 15.25, 11.75},
                {0.1, -0.05, 0.001, 0.002, 0.01, 0, 0, 0}, 0);
  expect_camera(info.tof, {{16, 12}, 16, 16, 7.5, 5.5}, {}, 0);
  EXPECT_TRUE(info.target_from_tof.translation_m.isApprox(Eigen::Vector3d(-0.03, 0, 0.01), 1e-12));
  capture::Capture frame;
  ASSERT_TRUE(take->read(2, frame));
  EXPECT_EQ(capture::plate_of(frame).at(3, 3), (Rgb8{11, 100, 200})) << "bgr8";
  EXPECT_FLOAT_EQ(frame.depth_m.at(3, 3), 1.501F);
  EXPECT_NE(test::read_bytes(folder_ / "take/depth.txt").find("\n100.004 "), std::string::npos);
}

TEST_F(Foreign, ABagThatCannotBeATakeIsRefusedByName) {
  const std::string bag = test::read_bytes(tiny_bag());
  const auto with = [&](std::string from, const std::string& to) {
    std::string changed = bag;
    for (std::size_t at = 0; (at = changed.find(from, at)) != std::string::npos; at += to.size())
      changed.replace(at, from.size(), to);
    return import_recording(folder_.write("changed.bag", changed), folder_ / "take");
  };
  EXPECT_TRUE(test::refused(with("compression=none", "compression=lz4x"), {"lz4x", "decompress"}));
  EXPECT_TRUE(
      test::refused(with("color/camera_info", "color/camera_infx"), {"no /cam/color/camera_info"}));
  EXPECT_TRUE(test::refused(with("/tf_static", "/tf_statix"), {"/tf_static", "depth_optical"}));
  EXPECT_TRUE(test::refused(with("bgr8", "yuv8"), {"/cam/color/image_raw", "yuv8"}));
  EXPECT_TRUE(test::refused(with("plumb_bob", "equi_bobs"), {"equi_bobs", "rectify"}));
  EXPECT_TRUE(
      test::refused(with("mono8", "bgra8"), {"2 topics of colour", "/cam/infra/image_raw"}));
  EXPECT_FALSE(fs::exists(folder_ / "take")) << "whole or not at all";
  const auto cut =
      import_recording(folder_.write("cut.bag", bag.substr(0, bag.size() / 2)), folder_ / "take");
  EXPECT_TRUE(test::refused(cut, {"colour"})) << "its only chunk is cut off";
}

TEST_F(Foreign, ASevenScenesSequenceHasPosesAndTwoUnknownSteps) {
  for (const int i : {0, 1}) {
    const std::string frame = "seq/frame-00000" + std::to_string(i);
    write_frame(folder_ / (frame + ".color.png"), folder_ / (frame + ".depth.png"), 1200);
    folder_.write(frame + ".pose.txt",
                  "1 0 0 " + std::to_string(i) + "\n0 1 0 2\n0 0 1 3\n0 0 0 1\n");
  }
  auto take = imported(folder_ / "seq");
  ASSERT_TRUE(take) << take.error().context;
  EXPECT_EQ(told_.frames, 2);
  EXPECT_EQ(take->info().tof.pinhole, (geometry::Pinhole{{32, 24}, 29.25, 29.25, 16, 12}));
  EXPECT_EQ(told_.assumed.size(), 3U);
  capture::Capture frame;
  ASSERT_TRUE(take->read(2, frame));
  EXPECT_EQ(frame.depth_m.at(0, 0), 0) << "65535";
  EXPECT_FLOAT_EQ(frame.depth_m.at(1, 0), 1.2F);
  EXPECT_TRUE(frame.world_from_target.translation_m.isApprox(Eigen::Vector3d(1.025, 2, 3)))
      << "the pose is the depth camera's, 25 mm beside";
}

TEST_F(Foreign, AScanNetSceneHasItsIntrinsicsAndLeavesOutPosesThatAreNone) {
  for (const int i : {0, 1, 10}) {
    const std::string n = std::to_string(i);
    write_frame(folder_ / "s/color" / (n + ".jpg"), folder_ / "s/depth" / (n + ".png"), 900);
    folder_.write("s/pose/" + n + ".txt",
                  i == 1 ? "-inf -inf -inf -inf\n" : "0 -1 0 0\n1 0 0 0\n0 0 1 0\n0 0 0 1\n");
  }
  folder_.write("s/intrinsic/intrinsic_color.txt", "60 0 31 0\n0 61 23 0\n0 0 1 0\n0 0 0 1\n");
  folder_.write("s/intrinsic/intrinsic_depth.txt", "30 0 15 0\n0 30 11 0\n0 0 1 0\n0 0 0 1\n");
  auto take = imported(folder_ / "s");
  ASSERT_TRUE(take) << take.error().context;
  EXPECT_EQ(told_.frames, 2);
  EXPECT_EQ(take->info().target.pinhole, (geometry::Pinhole{{64, 48}, 60, 61, 31, 23}));
  EXPECT_EQ(told_.assumed.size(), 3U) << "no extrinsics, and the rate";
  EXPECT_EQ(told_.lost.size(), 2U) << "one pose, and its frame";
}

TEST_F(Foreign, AStampedFolderKeepsItsFilesAndTheCameraOfItsSet) {
  const fs::path folder = folder_ / "rgbd_bonn_walk";
  fs::create_directories(folder);
  ASSERT_TRUE(image_io::write_png(folder / "a.png", Image<Rgb8>(Size{640, 480}).view()));
  ASSERT_TRUE(
      image_io::write_png(folder / "b.png", Image<std::uint16_t>(Size{640, 480}, 5000).view()));
  folder_.write("rgbd_bonn_walk/rgb.txt", "1500000000.25 a.png\n");
  folder_.write("rgbd_bonn_walk/depth.txt", "1500000000.26 b.png\n");
  auto take = imported(folder);
  ASSERT_TRUE(take) << take.error().context;
  expect_camera(take->info().target, {{640, 480}, 542.822841, 542.576870, 315.593520, 237.756098},
                {0.039903, -0.099343, -0.000730, -0.000144, 0, 0, 0, 0}, 0);
  EXPECT_EQ(test::read_bytes(folder_ / "take/depth/000001.png"),
            test::read_bytes(folder / "b.png"));
  capture::Capture frame;
  ASSERT_TRUE(take->read(1, frame));
  EXPECT_FLOAT_EQ(frame.depth_m.at(1, 0), 1.0F);
  EXPECT_NE(test::read_bytes(folder_ / "take/rgb.txt").find("1500000000.25 "), std::string::npos);
}

TEST_F(Foreign, WhatIsNoRecordingIsRefusedWithWhatToDo) {
  const auto of = [&](const char* name) {
    return import_recording(folder_.write(name, "x"), folder_ / "take");
  };
  EXPECT_TRUE(test::refused(import_recording(folder_ / "no", folder_ / "take"), {"no recording"}));
  EXPECT_TRUE(test::refused(of("a.mkv"), {"a.mkv", "COLOR"}));
  EXPECT_TRUE(test::refused(of("a.oni"), {"openni2:"}));
  EXPECT_TRUE(test::refused(of("a.mcap"), {"ROS 1 bag"}));
  EXPECT_TRUE(test::refused(of("a.txt"), {"7-Scenes"}));
}

}  // namespace
}  // namespace mixrig::take
