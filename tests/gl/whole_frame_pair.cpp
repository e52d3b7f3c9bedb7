// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/whole_frame_pair.h"

#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/gles/compositor_gles.h"

namespace mixrig::test {

double psnr_db(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const Rgb8 p = a.at(x, y), q = b.at(x, y);
      sum += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
    }
  const double mean = sum / (3.0 * static_cast<double>(a.size().area()));
  return mean > 0 ? 10 * std::log10(255 * 255 / mean) : 99;
}

Pair make_pair(const RoomSetup& room) {
  Pair pair;
  auto cpu = render::make_cpu_compositor(room.setup, 2);
  auto gles = render::make_gles_compositor(room.setup);
  EXPECT_TRUE(cpu) << cpu.error().context;
  EXPECT_TRUE(gles) << gles.error().context;
  if (cpu && gles) pair.cpu = std::move(*cpu), pair.gles = std::move(*gles);
  pair.cpu_frame.wanted = pair.gles_frame.wanted = render::kAll;
  return pair;
}

void expect_agreement(Pair& pair, const render::FrameInput& frame) {
  ASSERT_TRUE(pair.cpu && pair.gles);
  const auto first = pair.cpu->compose(frame, pair.cpu_frame);
  const auto second = pair.gles->compose(frame, pair.gles_frame);
  ASSERT_TRUE(first) << first.error().context;
  ASSERT_TRUE(second) << second.error().context;
  const render::FrameOutput &cpu = pair.cpu_frame, &gles = pair.gles_frame;
  EXPECT_GE(psnr_db(cpu.color, gles.color), 45);
  EXPECT_GE(share_within(cpu.warped_depth_m, gles.warped_depth_m, 0.002), 0.995);
  EXPECT_GE(share_within(cpu.mixed_depth_m, gles.mixed_depth_m, 0.002), 0.995);
  EXPECT_GE(share_within(cpu.segmented_depth_m, gles.segmented_depth_m, 0.002), 0.995);
  EXPECT_GE(share_within(cpu.matte, gles.matte, 8), 0.995);
  EXPECT_GE(share_within(cpu.state, gles.state, 0), 0.995);
  EXPECT_GE(share_within(cpu.light, gles.light, 0.02), 0.995);
  EXPECT_GE(share_within(cpu.layer, gles.layer, 0), 0.998);
  EXPECT_GE(share_within(cpu.alpha, gles.alpha, 8), 0.995);
  testing::Test::RecordProperty("psnr_db", std::to_string(psnr_db(cpu.color, gles.color)));
}

void expect_agreement(const RoomSetup::Options& options) {
  const RoomSetup room(options);
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
}

bool shows(const render::FrameOutput& frame, render::Layer layer) {
  for (int y = 0; y < frame.layer.height(); ++y)
    for (int x = 0; x < frame.layer.width(); ++x)
      if (frame.layer.at(x, y) == static_cast<std::uint8_t>(layer)) return true;
  return false;
}

float time_of(const Pair& pair, render::Stage stage) {
  return pair.gles->state().stage_times[static_cast<std::size_t>(stage)];
}

render::FrameInput volume_frame(RoomSetup& room) {
  Eigen::Matrix3d axes;  // columns: right, down, forward
  axes.col(0) = -Eigen::Vector3d::UnitY();
  axes.col(1) = -Eigen::Vector3d::UnitZ();
  axes.col(2) = Eigen::Vector3d::UnitX();
  const geometry::Pose world_from_target{Eigen::Quaterniond(axes), {0, 0, room.scene.floor_y_m}};
  room.setup.background = {};
  room.setup.capture_box = render::CaptureBox{{1.5, -1.5, 0}, {3.5, 1.5, 2.4}};
  for (render::VirtualObject& object : room.setup.objects)
    object.world_from_object = world_from_target * object.world_from_object;
  for (geometry::Lamp& lamp : room.setup.light.lamps) {
    lamp.position_m = world_from_target * lamp.position_m;
    if (lamp.direction) lamp.direction = -Eigen::Vector3d::UnitZ();
  }
  render::FrameInput frame = room.frame();
  frame.world_from_target = world_from_target;
  return frame;
}

void expect_agreement_as_it_turns(Pair& pair, render::FrameInput frame) {
  expect_agreement(pair, frame);
  frame.world_from_target.translation_m = {0.02, 0.01, 0};
  frame.world_from_target.rotation = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY());
  expect_agreement(pair, frame);
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kPerson));
}

}  // namespace mixrig::test
