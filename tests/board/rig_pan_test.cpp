// SPDX-License-Identifier: Apache-2.0
// The command composites a rig that pans: the emulated unit turns, the colour camera sees the room
// at its angle, and a virtual post stays where it is in the room.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <thread>

#include "host/capture/calibration_file/calibration.h"
#include "host/math/image_io/image_io.h"
#include "tests/board/rig_bench.h"
#include "tests/support/hand_gltf.h"

namespace mixrig::board {
namespace {

constexpr int kFrames = 100, kFarthest_steps = 350;  // 18 degrees to either side

/// A calibration whose axes intersect in the target camera; at angles zero the camera has the
/// world's axes.
calibration_file::Calibration centred_chain(const VirtualRig& rig) {
  calibration_file::Calibration known;
  geometry::CameraModel target, tof;
  target.pinhole = {{160, 90}, rig.room.focal_px, rig.room.focal_px, rig.room.centre_px, 44.5};
  tof.pinhole = {{160, 120}, 144, 144, 79.5, 59.5};
  known.cameras = {{"target", target, {}, 0, 0, 0, {}}, {"tof", tof, {}, 0, 0, 0, {}}};
  known.poses.push_back({"tof", {}, {}, 0, 0, {}});
  known.pan_tilt.emplace();
  known.pan_tilt->head_from_target.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  known.pan_tilt->tilt.direction = Eigen::Vector3d::UnitX();
  return known;
}

/// A red plate, 3 cm wide, 30 cm straight ahead, in the lower half of the picture: nearer than
/// anything that the ToF camera sees. glTF's (x, y, z) is (x, z, -y) of the world's axes here.
std::string red_plate() {
  return test::glb(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"materials":[{"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"buffers":[{"byteLength":72}],"bufferViews":[{"buffer":0,"byteLength":72}],
"accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3",
"min":[-0.015,0.3,-0.06],"max":[0.015,0.3,-0.015]}]})",
      test::floats({-0.015F, 0.3F, -0.015F, 0.015F, 0.3F, -0.015F, 0.015F, 0.3F, -0.06F, -0.015F,
                    0.3F, -0.015F, 0.015F, 0.3F, -0.06F, -0.015F, 0.3F, -0.06F}));
}

void write_scene(const VirtualRig& rig) {
  fs::create_directories("/tmp/pan");
  std::ofstream("/tmp/pan/plate.glb", std::ios::binary) << red_plate();
  ASSERT_TRUE(calibration_file::write_calibration("/tmp/pan/calibration.toml", centred_chain(rig)));
  std::ofstream("/tmp/pan/scene.toml")
      << "calibration = \"calibration.toml\"\n[camera]\npose = \"pan_tilt\"\n"
         "world_from_base = { rotation_xyzw = [0.70710678, 0.0, 0.0, 0.70710678], "
         "translation_m = [0.0, 0.0, 0.0] }\n[[object]]\nname = \"plate\"\nmodel = \"plate.glb\"\n"
         "position_m = [0.0, 0.0, 0.0]\n[light]\nambient = [1.0, 1.0, 1.0]\nexposure = 1.0\n";
}

/// Mean column of the red pixels; NaN where there are none.
double red_px(const Image<Rgb8>& picture) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      if (const Rgb8& p = picture.at(x, y); p.r > p.g + 60) sum += x, ++count;
  return sum / count;
}

/// Reads poses; for each line, whether the frame has a pose.
std::vector<bool> frames_with_pose(const char* path) {
  std::ifstream in(path);
  std::vector<bool> known;
  std::string line;
  std::getline(in, line);  // the names of the columns
  while (std::getline(in, line)) known.push_back(line.find(",ok,") != std::string::npos);
  return known;
}

TEST_F(Rig, APanningHeadIsFollowedAndTheObjectStays) {
  rig_.show_room();
  write_scene(rig_);
  fs::remove_all("/tmp/panned");
  std::atomic<bool> done = false;
  Ran ran;
  std::thread composite([&] {
    ran = run(std::string("mixrig run /tmp/pan/scene.toml --backend cpu --format png --frames 1-") +
              std::to_string(kFrames) + " --out /tmp/panned --source rig:" + kConfig);
    done = true;
  });
  SystemClock clock;
  rig_.head.order("PS250 ", clock.now());
  for (int target = kFarthest_steps; !done; target = -target) {
    rig_.head.order("PP" + std::to_string(target) + " ", clock.now());
    (void)wait_until([&] { return done || rig_.head.position(clock.now())[0] == target; });
  }
  composite.join();
  ASSERT_EQ(ran.status, 0) << ran.text;
  const Json pose = read_json("/tmp/panned/report.json")["pose"];
  EXPECT_EQ(pose["source"], "pan_tilt");
  EXPECT_LE(pose["lost"].get<int>(), 5) << pose;
  const std::vector<bool> known = frames_with_pose("/tmp/panned/frames.csv");
  ASSERT_EQ(std::ssize(known), kFrames);
  double low_px = 1e9, high_px = 0, last_px = 0;
  std::vector<double> errors_px;
  for (int number = 1; number <= kFrames; ++number) {
    char name[64];
    std::snprintf(name, sizeof name, "/tmp/panned/composite/color/%06d.png", number);
    Image<Rgb8> picture;
    ASSERT_TRUE(image_io::read_rgb8(name, picture));
    const double object_px = red_px(picture);
    const double bar_px =
        test::bar_in_row(picture.width(), [&](int x) { return picture.at(x, 20).g; });
    if (!known[static_cast<std::size_t>(number - 1)]) {
      if (!errors_px.empty()) {
        EXPECT_EQ(object_px, last_px) << "frozen where the pose is lost: " << number;
      }
      continue;
    }
    if (!std::isfinite(object_px) || !std::isfinite(bar_px)) continue;
    last_px = object_px;
    low_px = std::min(low_px, object_px), high_px = std::max(high_px, object_px);
    errors_px.push_back(std::abs(object_px - bar_px));
  }
  ASSERT_GE(std::ssize(errors_px), kFrames - 10);
  std::sort(errors_px.begin(), errors_px.end());
  const double most_px = errors_px[errors_px.size() * 8 / 10], worst_px = errors_px.back();
  measured(
      "%zu composites of a panning rig, the object from column %.1f to %.1f; from the bar that it "
      "stands at 80 %% within %.2f px, worst %.2f px; pose lost in %d frames",
      errors_px.size(), low_px, high_px, most_px, worst_px, pose["lost"].get<int>());
  EXPECT_GT(high_px - low_px, 50) << "the head has turned";
  // The mask has whole pixels, the unit's steps are 0.12 px.
  EXPECT_LT(most_px, 0.75);
  // Answers of the unit are 70 ms apart, and it reverses at once at 0.22 rad/s: an angle between
  // two answers is off by at most 0.22 * 0.035 rad, 1.08 px.
  EXPECT_LT(worst_px, 1.8);
}

}  // namespace
}  // namespace mixrig::board
