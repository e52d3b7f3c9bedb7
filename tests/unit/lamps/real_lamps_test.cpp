// SPDX-License-Identifier: Apache-2.0
// Bright regions of real fisheye pictures, and of real panoramas resampled into a fisheye.
#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "hal/base/srgb.h"
#include "host/math/geometry/fisheye_model.h"
#include "host/math/image_io/image_io.h"
#include "host/room/lamps/bright_regions.h"
#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

class RealLamps : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("MIXRIG_DATA");
    if (root == nullptr)
      GTEST_SKIP() << "needs fisheye-room-lights and hdri-indoor: set MIXRIG_DATA to the folder "
                      "that holds them";
    root_ = root;
  }
  std::vector<BrightRegion> regions(const std::string& picture,
                                    const geometry::FisheyeModel& lens) const {
    Image<Rgb8> image;
    const auto read = image_io::read_rgb8(root_ + "/fisheye-room-lights/" + picture, image);
    EXPECT_TRUE(read) << read.error().context;
    return find_bright_regions(image, [&](const Vector2d& px) { return lens.unproject(px); });
  }
  std::string root_;
};

geometry::FisheyeModel t265() {
  return geometry::FisheyeModel({{848, 800},
                                 285.722,
                                 286.759,
                                 420.135,
                                 403.394,
                                 {-0.00659769, 0.0473251, -0.0458264, 0.00897725}});
}
geometry::FisheyeModel tum_vi() {
  return geometry::FisheyeModel({{512, 512},
                                 190.98,
                                 190.97,
                                 254.93,
                                 256.90,
                                 {0.0034823894022493434, 0.0007150348452162257,
                                  -0.0020532361418706202, 0.00020293673591811182}});
}

const BrightRegion* at(const std::vector<BrightRegion>& all, const Vector2d& px) {
  for (const BrightRegion& r : all)
    if ((r.centre_px - px).norm() < 6) return &r;
  return nullptr;
}

/// Classifies by the region's border alone: one picture has no path of the camera.
bool looks_like_lamp(const BrightRegion& r) { return r.surround < LampOptions{}.most_surround; }

TEST_F(RealLamps, ListedLampsAreCandidatesAndWhiteThingsFade) {
  const auto office = regions("t265_fs1.png", t265());
  const auto lab = regions("t265_robot1.png", t265());
  const auto room = regions("tumvi_room_cam0.png", tum_vi());
  for (const auto* all : {&office, &lab, &room}) {
    for (const BrightRegion& r : *all)
      std::printf("  %4d px at (%.1f, %.1f) surround %.2f %s\n", r.pixels, r.centre_px.x(),
                  r.centre_px.y(), r.surround, r.cut ? "cut" : "");
    std::printf("\n");
  }
  for (const auto& [all, px] :
       {std::pair{&office, Vector2d(503.6, 61.9)}, std::pair{&lab, Vector2d(199.0, 111.6)},
        std::pair{&lab, Vector2d(663.8, 139.0)}, std::pair{&room, Vector2d(337.0, 74.1)},
        std::pair{&room, Vector2d(145.8, 69.6)}, std::pair{&room, Vector2d(439.5, 124.7)}}) {
    const BrightRegion* lamp = at(*all, px);
    ASSERT_NE(lamp, nullptr) << px.transpose();
    EXPECT_TRUE(looks_like_lamp(*lamp)) << px.transpose() << " surround " << lamp->surround;
  }
  for (const Vector2d& px :
       {Vector2d(293.3, 527.6), Vector2d(279.5, 459.2), Vector2d(297.6, 314.9)}) {
    const BrightRegion* robot = at(office, px);
    ASSERT_NE(robot, nullptr) << px.transpose();
    EXPECT_FALSE(looks_like_lamp(*robot)) << px.transpose() << " surround " << robot->surround;
  }
}

}  // namespace
}  // namespace mixrig::lights
