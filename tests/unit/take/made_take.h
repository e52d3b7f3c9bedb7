// SPDX-License-Identifier: Apache-2.0
// A small take with pixels that a test can compute.
#pragma once

#include <random>

#include "host/capture/take/take.h"
#include "tests/support/each_pixel.h"

namespace mixrig::take {

inline constexpr Size kColorSize{33, 20}, kDepthSize{17, 12};

inline TakeInfo made_info() {
  TakeInfo info;
  info.name = "a \"made\" take\n";
  info.amplitude_is_light = true;
  info.color.rate_hz = info.depth.rate_hz = 30.0;
  info.target.pinhole = {kColorSize, 30.0, 30.5, 16.0, 9.5};
  info.target.lens = geometry::Lens({-0.1, 0.01, 0.001, -0.002, 0, 0, 0, 0});
  info.tof.pinhole = {kDepthSize, 15.0, 15.0, 8.0, 5.5};
  info.view = geometry::Pinhole{kColorSize, 31.0, 31.0, 16.0, 9.5};
  info.target_from_tof = {Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())),
                          {-0.05, 0.01, 0.002}};
  info.noise = {0.003, 0.001, 0.0007};
  info.has_poses = true;
  return info;
}

/// A frame whose pixels are noise, which no lossy encoder would preserve.
inline capture::Capture made_frame(int number) {
  std::mt19937 random(static_cast<unsigned>(number));
  capture::Capture frame;
  frame.number = number;
  frame.time_s = (number - 1) / 30.0;
  frame.plate.reset(kColorSize);
  frame.depth_m.reset(kDepthSize);
  frame.amplitude.reset(kDepthSize);
  for (const auto [x, y] : test::each_pixel(kColorSize))
    frame.plate.at(x, y) = {static_cast<std::uint8_t>(random()),
                            static_cast<std::uint8_t>(random()),
                            static_cast<std::uint8_t>(random())};
  for (const auto [x, y] : test::each_pixel(kDepthSize)) {
    frame.depth_m.at(x, y) = static_cast<float>(random() % 8000) * 0.001F;
    frame.amplitude.at(x, y) = static_cast<float>(random() % 65536);
  }
  frame.world_from_target = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * number, Eigen::Vector3d::UnitZ())),
      {1.0 * number, 2, 3}};
  return frame;
}

inline capture::Truth made_truth() {
  capture::Truth truth;
  truth.depth_m.reset(kColorSize, 2.5F);
  truth.light.reset(kColorSize, 0.5F);
  truth.matte.reset(kColorSize, 200);
  truth.composite.reset(kColorSize, {1, 2, 3});
  truth.labels.reset(kColorSize, 13);
  return truth;
}

}  // namespace mixrig::take
