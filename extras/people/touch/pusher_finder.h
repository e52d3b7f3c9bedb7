// SPDX-License-Identifier: Apache-2.0
// Converts the surface of people to moving balls that push objects.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::touch {

/// Ball that stands for a part of a person's surface.
struct Pusher {
  static constexpr float kRadius_m = 0.05F;
  Eigen::Vector3f at_m = Eigen::Vector3f::Zero();  ///< its middle, world
  Eigen::Vector3f velocity_m_s = Eigen::Vector3f::Zero();
};

/// Makes balls from the surface of people near the objects, in cells of a third of a ball's width.
/// A ball's velocity follows from the nearest cell of the frame before, along the motion (normal
/// flow). One thread; no allocation once the buffers have grown.
class PusherFinder {
 public:
  static constexpr double kReach_m = 0.6;  ///< from an object
  /// Precondition: time grows.
  std::span<const Pusher> find(std::span<const Eigen::Vector3f> surface_m,
                               const Eigen::Vector3d& eye_m, double time_s);

 private:
  struct Cell {
    long key = 0;
    Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();
    int count = 0;
  };
  std::vector<Cell> cells_;
  std::vector<Eigen::Vector3f> before_m_, now_m_;
  std::vector<Pusher> pushers_;
  double before_s_ = 0;
  bool has_before_ = false;
};

}  // namespace mixrig::touch
