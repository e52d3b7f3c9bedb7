// SPDX-License-Identifier: Apache-2.0
// Model of multipath: the error that light reflected by other surfaces causes in the distances of a
// phase camera with three frequencies.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace mixrig::depth {

/// A pixel receives the light of its surface and a later tail, whose strength falls exponentially
/// with its extra path. Relative to the surface its phasor is share / (1 - i w), w being the phase
/// of the tail's mean extra path. It changes low frequencies most. Two numbers determine share and
/// path: by how much the coarsest frequency sees farther than the finest, and the light of the
/// finest over that of the coarsest. The constructor makes a table over these two numbers. Const
/// methods are thread-safe.
class BouncedLight {
 public:
  /// `range_m`: ranges of the frequencies in their order: the second is the coarsest, the third the
  /// finest.
  explicit BouncedLight(const std::array<double, 3>& range_m);

  struct Effect {
    float fine_m = 0;       ///< error of the finest frequency's distance
    float spread_m = 0;     ///< distance by the first frequency minus that by the finest
    float first_light = 1;  ///< light of the first frequency over that of the coarsest
  };
  /// Looks up the effect. `coarse_m`: distance by the coarsest frequency minus that by the finest;
  /// `fine_light`: light of the finest over that of the coarsest. Values outside the table are
  /// clamped to its border.
  Effect at(float coarse_m, float fine_light) const;
  /// Whether the table covers these values; false for stronger tails.
  static bool covers(float coarse_m, float fine_light);

 private:
  const Effect& entry(int coarse, int light) const;
  std::vector<Effect> table_;
};

}  // namespace mixrig::depth
