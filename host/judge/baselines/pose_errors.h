// SPDX-License-Identifier: Apache-2.0
// Errors of the poses that frames were composited with, against the true poses.
#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/quantile_sketch.h"
#include "host/math/geometry/pose.h"

namespace mixrig::session {

/// Collects pose errors in constant memory.
class PoseErrors {
 public:
  /// Adds one frame: both poses of the target camera, in the same world.
  void add(const geometry::Pose& used, const geometry::Pose& truth);
  /// Leaves out a frame without a pose.
  void skip() { before_.reset(), last_.reset(); }
  std::uint64_t frames() const { return shift_mm_.count(); }
  /// {"frames", "shift_mm": {"rms", "p50", "p95", "max"}, "turn_deg": {...}, "jitter": {"shift_mm",
  /// "turn_deg"}}. Shift is the distance of the two positions, turn the angle between the two
  /// orientations. Jitter is the root mean square of the second difference of the error from frame
  /// to frame; null without three frames in a row.
  nlohmann::json to_json() const;
  /// The figures of to_json() as one line of text.
  std::string to_line() const;

 private:
  struct Off {
    Eigen::Vector3d shift_mm, turn_deg;
  };
  measure::QuantileSketch shift_mm_, turn_deg_;
  double shift_square_mm2_ = 0, turn_square_deg2_ = 0;  ///< sums
  std::optional<Off> before_, last_;                    ///< errors of the two frames before
  std::uint64_t triples_ = 0;
  double shift_jitter_mm2_ = 0, turn_jitter_deg2_ = 0;  ///< sums
};

}  // namespace mixrig::session
