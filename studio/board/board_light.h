// SPDX-License-Identifier: Apache-2.0
// The light on a board.
#pragma once

#include <algorithm>
#include <array>

#include "studio/board/board_pattern.h"
#include "studio/stage/light.h"

namespace mixrig::studio {

/// Irradiance on the board, interpolated bilinearly between samples.
class BoardLight {
 public:
  /// `ambient` is added everywhere.
  BoardLight(const BoardPlan& plan, const geometry::Pose& world_from_board, const LampSet& lamps,
             float ambient)
      : plan_(plan) {
    const Eigen::Matrix3d turn = world_from_board.rotation.toRotationMatrix();
    const Vec3 normal = (-turn.col(2)).cast<float>();
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const Eigen::Vector3d place(u_of(i), v_of(j), 0);
        const Vec3 at = (world_from_board * place).cast<float>();
        values_[static_cast<std::size_t>(j) * kSide + i] =
            ambient + lamps.irradiance(at, normal, lamps.facing(at, normal));
      }
  }
  float at(float u_m, float v_m) const {
    const float x = cell(u_m, plan_.width_m()), y = cell(v_m, plan_.height_m());
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const float* row = &values_[static_cast<std::size_t>(j) * kSide + i];
    return (1 - t) * ((1 - s) * row[0] + s * row[1]) +
           t * ((1 - s) * row[kSide] + s * row[kSide + 1]);
  }

 private:
  static constexpr int kSide = 9;  ///< samples, per side; the outermost lie beyond the board

  static float cell(float at_m, double size_m) {
    const float x = at_m / static_cast<float>(size_m) * (kSide - 3) + 1;
    return std::clamp(x, 0.0F, kSide - 1.001F);
  }
  double u_of(int i) const { return plan_.width_m() * (i - 1) / (kSide - 3); }
  double v_of(int j) const { return plan_.height_m() * (j - 1) / (kSide - 3); }

  BoardPlan plan_;
  std::array<float, static_cast<std::size_t>(kSide) * kSide> values_;
};

}  // namespace mixrig::studio
