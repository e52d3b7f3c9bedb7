// SPDX-License-Identifier: Apache-2.0
// Motion blur of virtual things against the mean of many sharp composites along the way.
#include <cmath>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/render/frame/frame_motion.h"
#include "tests/gl/room_setup.h"

namespace mixrig::test {
namespace {

/// The virtual box before one plate, without people and lamps.
struct BoxBeforePlate {
  RoomSetup room{
      {.lamps = false, .background = false, .background_color = false, .box_m = {0.2, 0.5, 2.4}}};
  Image<float> no_depth_m{room.depth.size()};

  Image<Rgb8> composite(bool blurs, const geometry::Pose& world_from_target,
                        const std::optional<render::CameraMotion>& motion) {
    room.setup.look.motion = blurs;
    auto compositor = render::make_cpu_compositor(room.setup, 1);
    EXPECT_TRUE(compositor);
    render::FrameOutput output;
    output.wanted = render::kColor;
    render::FrameInput input = room.frame();
    input.tof_depth_m = no_depth_m;
    input.world_from_target = world_from_target, input.motion = motion;
    EXPECT_TRUE((*compositor)->compose(input, output));
    return std::move(output.color);
  }
};

/// The camera at a time from -1/2 to 1/2 of the exposure: still points move by `motion` over it.
geometry::Pose pose_at(const render::CameraMotion& motion, double time) {
  const Eigen::Vector3d turn(motion.turn_rad.x, motion.turn_rad.y, motion.turn_rad.z);
  const Eigen::Vector3d shift_m(motion.shift_m.x, motion.shift_m.y, motion.shift_m.z);
  const double angle = turn.norm();
  const Eigen::AngleAxisd turned(
      time * angle, angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX());
  return geometry::inverse(geometry::Pose{Eigen::Quaterniond(turned), time * shift_m});
}

/// PSNR of linear light over the pixels where a or b is not the plate.
double psnr_of_box(const Image<glm::dvec3>& truth, const Image<Rgb8>& shown,
                   const Image<Rgb8>& plate) {
  const auto& linear = linear_of_srgb_bytes();
  double sum = 0, count = 0;
  for (int y = 0; y < shown.height(); ++y)
    for (int x = 0; x < shown.width(); ++x) {
      const auto light = [&](Rgb8 c) { return glm::dvec3(linear[c.r], linear[c.g], linear[c.b]); };
      const glm::dvec3 t = truth.at(x, y), s = light(shown.at(x, y)), p = light(plate.at(x, y));
      if (glm::length(t - p) < 0.01 && glm::length(s - p) < 0.01) continue;
      sum += glm::dot(t - s, t - s), count += 3;
    }
  return 10 * std::log10(count / sum);
}

Image<glm::dvec3> mean_along(BoxBeforePlate& box, const render::CameraMotion& motion) {
  constexpr int kMoments = 32;
  const auto& linear = linear_of_srgb_bytes();
  Image<glm::dvec3> mean(box.room.plate.size(), glm::dvec3(0));
  for (int i = 0; i < kMoments; ++i) {
    const Image<Rgb8> sharp =
        box.composite(false, pose_at(motion, (i + 0.5) / kMoments - 0.5), std::nullopt);
    for (int y = 0; y < mean.height(); ++y)
      for (int x = 0; x < mean.width(); ++x) {
        const Rgb8 c = sharp.at(x, y);
        mean.row(y)[x] += glm::dvec3(linear[c.r], linear[c.g], linear[c.b]) / double(kMoments);
      }
  }
  return mean;
}

TEST(Motion, BlursAsTheMeanOfManyMoments) {
  const render::CameraMotion pan{.turn_rad = {0, 0.025F, 0}};
  const render::CameraMotion dolly{.shift_m = {0.06F, -0.03F, 0}};
  const render::CameraMotion roll{.turn_rad = {0.006F, 0, 0.05F}, .shift_m = {0, 0, 0.08F}};
  for (const render::CameraMotion& motion : {pan, dolly, roll}) {
    BoxBeforePlate box;
    const Image<glm::dvec3> truth = mean_along(box, motion);
    const Image<Rgb8> sharp = box.composite(false, {}, motion),
                      blurred = box.composite(true, {}, motion);
    const double before = psnr_of_box(truth, sharp, box.room.plate);
    const double after = psnr_of_box(truth, blurred, box.room.plate);
    EXPECT_GT(after, before + 8);
    EXPECT_GT(after, 36);
    RecordProperty("psnr_db", std::to_string(before) + " " + std::to_string(after));
  }
}

TEST(Motion, OfACameraThatStandsStillBlursNothing) {
  BoxBeforePlate box;
  const Image<Rgb8> sharp = box.composite(false, {}, std::nullopt);
  const render::CameraMotion little{.turn_rad = {0, 0.0005F, 0}};
  for (const auto& motion : {std::optional<render::CameraMotion>(), std::optional(little)}) {
    const Image<Rgb8> shown = box.composite(true, {}, motion);
    for (int y = 0; y < sharp.height(); ++y)
      for (int x = 0; x < sharp.width(); ++x) ASSERT_EQ(shown.at(x, y), sharp.at(x, y));
  }
}

TEST(Motion, WaysAreThoseOfProjectedPoints) {
  const render::CameraMotion motion{.turn_rad = {0.002F, -0.003F, 0.004F},
                                    .shift_m = {0.004F, 0.002F, -0.006F}};
  render::MotionParams params;
  params.motion = motion, params.focal_px = {300, 310}, params.center_px = {160, 120};
  const Eigen::Vector3d p(0.4, -0.3, 2);
  const auto px = [&](double time) {
    const Eigen::Vector3d q = geometry::inverse(pose_at(motion, time)) * p;
    return glm::vec2(300 * q.x() / q.z() + 160, 310 * q.y() / q.z() + 120);
  };
  const glm::vec2 way = render::motion_px(params, px(0), 0.5F), true_way = px(0.5) - px(-0.5);
  EXPECT_NEAR(way.x, true_way.x, 0.01);
  EXPECT_NEAR(way.y, true_way.y, 0.01);
  params.motion.turn_rad.y = 3;
  EXPECT_NEAR(glm::length(render::motion_px(params, px(0), 0.5F)), render::kMostMotionPx, 1e-3);
}

}  // namespace
}  // namespace mixrig::test
