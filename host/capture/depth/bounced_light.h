// SPDX-License-Identifier: Apache-2.0
// What light that reaches the camera over other surfaces does to the distances of a phase camera
// with three frequencies.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace mixrig::depth {

/// A pixel's light is that of its surface and a tail that comes later, whose strength falls off
/// exponentially with its way: its phasor over that of the surface is share / (1 - i w), w the
/// phase of the tail's mean further way. It bends low frequencies most. Two numbers tell both
/// parameters: by how much the coarsest frequency sees farther than the finest, and the light of
/// the finest over that of the coarsest. A table of them, made once. Const methods are thread-safe.
class BouncedLight {
 public:
  /// Ranges of the frequencies in their order: the second is the coarsest, the third the finest.
  explicit BouncedLight(const std::array<double, 3>& range_m);

  struct Effect {
    float fine_m = 0;       ///< error of the finest frequency's distance
    float spread_m = 0;     ///< distance by the first less that by the finest
    float first_light = 1;  ///< light of the first over that of the coarsest
  };
  /// `coarse_m`: distance by the coarsest less that by the finest; `fine_light`: light of the
  /// finest over that of the coarsest. Beyond the table its border.
  Effect at(float coarse_m, float fine_light) const;
  /// False where a tail is stronger than those of the table.
  static bool covers(float coarse_m, float fine_light);

 private:
  const Effect& entry(int coarse, int light) const;
  std::vector<Effect> table_;
};

}  // namespace mixrig::depth
