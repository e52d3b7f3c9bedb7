// SPDX-License-Identifier: Apache-2.0
// Captures of a drawn board by a target and a depth camera.
#pragma once

#include <chrono>

#include "host/capture/capture/capture_source.h"
#include "tests/unit/calibrate/drawn_board.h"

namespace mixrig::test {

inline const calibration::BoardSpec kDrawnBoard{
    calibration::BoardKind::kCheckerboard, 9, 6, 0.04, 0, 0, {}};
inline const DrawnCamera kColor{{320, 240}, 300, 158.2, 121.4, -0.1};
inline const DrawnCamera kDepth{{176, 144}, 150, 87.1, 70.8, -0.1};

inline geometry::Pose facing(double x_m, double y_m, double z_m,
                             Eigen::Vector3d turn = {0.3, 0.2, 0.1}) {
  return board_pose(kDrawnBoard, turn, {x_m, y_m, z_m});
}

/// Frame `number` of 25 a second.
inline capture::Capture frame(int number, const geometry::Pose& pose, double blur_px = 0.6,
                              const geometry::Pose* in_depth = nullptr, double nearer_m = 0) {
  DrawnLook look;
  look.blur_px = blur_px, look.noise = 6;
  capture::Capture c;
  c.number = number;
  c.mid_exposure = HostTime(std::chrono::milliseconds(40 * number));
  const auto gray = draw_board(kDrawnBoard, kColor, pose, look, static_cast<unsigned>(2 * number));
  c.plate.reset(gray.size());
  for (int y = 0; y < gray.height(); ++y)
    for (int x = 0; x < gray.width(); ++x)
      c.plate.at(x, y) = {gray.at(x, y), gray.at(x, y), gray.at(x, y)};
  const auto ir = draw_board(kDrawnBoard, kDepth, in_depth != nullptr ? *in_depth : pose, {},
                             static_cast<unsigned>(2 * number + 1));
  c.amplitude.reset(ir.size()), c.depth_m.reset(ir.size());
  for (int y = 0; y < ir.height(); ++y)
    for (int x = 0; x < ir.width(); ++x) {
      c.amplitude.at(x, y) = 20.0F * ir.at(x, y);
      c.depth_m.at(x, y) =
          static_cast<float>(0.8 - nearer_m + 0.002 * ((x * 7 + y * 13 + number * 5) % 11 - 5));
    }
  c.set_status(capture::Stream::kPlate, capture::StreamStatus::kFresh);
  c.set_status(capture::Stream::kDepth, capture::StreamStatus::kFresh);
  return c;
}

inline capture::SourceInfo source_info() {
  capture::SourceInfo info;
  info.name = "drawn", info.frames = 1000, info.depth_unit_m = 0.001;
  info.target.pinhole = {kColor.size_px, kColor.focal_px, kColor.focal_px, 159.5, 119.5};
  return info;
}

}  // namespace mixrig::test
