// SPDX-License-Identifier: Apache-2.0
// The surface of people as what pushes objects.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::touch {

/// A part of a person's surface, as a ball that moves.
struct Pusher {
  static constexpr float kRadius_m = 0.05F;
  Eigen::Vector3f at_m = Eigen::Vector3f::Zero();  ///< its middle, world
  Eigen::Vector3f velocity_m_s = Eigen::Vector3f::Zero();
};

/// The surface of people near the objects, as balls in cells of a third of their width, whose
/// velocity is that of the nearest cell of the frame before, along the motion (normal flow). One
/// thread; no allocation once the buffers have grown.
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
