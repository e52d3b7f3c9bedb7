// SPDX-License-Identifier: Apache-2.0
// The command composites a rig that pans: the emulated unit turns, the colour camera sees the room
// at its angle, and a virtual post stays where it is in the room.
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

#include "host/calibration_file/calibration.h"
#include "host/image_io/image_io.h"
#include "tests/board/rig_bench.h"
#include "tests/support/hand_gltf.h"

namespace mixrig::board {
namespace {

constexpr int kFrames = 50, kFarthest_steps = 350;  // 18 degrees to either side

/// Axes that intersect in the target camera; at angles zero it has the world's axes.
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
  double low_px = 1e9, high_px = 0, worst_px = 0;
  int seen = 0;
  for (int number = 1; number <= kFrames; ++number) {
    char name[64];
    std::snprintf(name, sizeof name, "/tmp/panned/composite/color/%06d.png", number);
    Image<Rgb8> picture;
    if (!image_io::read_rgb8(name, picture)) continue;
    const double object_px = red_px(picture);
    const double bar_px =
        test::bar_in_row(picture.width(), [&](int x) { return picture.at(x, 20).g; });
    if (!std::isfinite(object_px) || !std::isfinite(bar_px)) continue;
    ++seen;
    low_px = std::min(low_px, object_px), high_px = std::max(high_px, object_px);
    worst_px = std::max(worst_px, std::abs(object_px - bar_px));
  }
  measured(
      "%d composites of a panning rig, the object from column %.1f to %.1f, at most %.2f px "
      "from the bar it stands at; pose lost in %d frames",
      seen, low_px, high_px, worst_px, pose["lost"].get<int>());
  EXPECT_GE(seen, kFrames - 5);
  EXPECT_GT(high_px - low_px, 50) << "the head has turned";
  // Answers of the unit are 70 ms apart, whole steps of 0.12 px, and its speed of 0.22 rad/s
  // changes by 1.8 rad/s^2 at the ends: 1/8 of it times 0.07 s^2 is 0.15 px. The mask has whole
  // pixels.
  EXPECT_LT(worst_px, 1.0);
}

}  // namespace
}  // namespace mixrig::board
