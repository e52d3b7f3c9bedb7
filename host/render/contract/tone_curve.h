// SPDX-License-Identifier: Apache-2.0
// How the camera's tones differ from those it had when the background was learned.
#pragma once

#include <array>

#include <glm/glm.hpp>

#include "host/render/contract/constants.h"

namespace mixrig::render {

/// Maps learned linear light to the light of the plate, a channel at a time: straight pieces
/// between 0 and knots that double from kToneFirstKnot on; the last piece has no end. A camera that
/// only changes its gain has one slope. Cameras that compress bright light (most with automatic
/// exposure) brighten dark places more than bright ones.
struct ToneCurve {
  glm::vec3 gain{1};                              ///< of most of the picture
  bool bends = false;                             ///< false: every slope equals the gain
  std::array<glm::vec3, kTonePieces> slope = {};  ///< each 0 or more

  ToneCurve() : ToneCurve(glm::vec3(1)) {}
  explicit ToneCurve(const glm::vec3& of_all) : gain(of_all) { slope.fill(of_all); }

  /// The curve at `light` of one channel, or of all channels as a vector type. T is a float or a
  /// register of floats; `least` is min() of two of them, `most` max().
  template <typename T, typename Least, typename Most>
  T at(const T& light, int channel, Least least, Most most) const {
    T sum = slope[0][channel] * least(light, T{} + kToneFirstKnot);
    float knot = kToneFirstKnot;
    for (int i = 1; i < kTonePieces; ++i, knot *= 2) {
      const T above = most(light - knot, T{});
      const T part = i + 1 < kTonePieces ? least(above, T{} + knot) : above;
      sum += slope[static_cast<std::size_t>(i)][channel] * part;
    }
    return sum;
  }
  glm::vec3 operator()(const glm::vec3& light) const {
    if (!bends) return gain * light;
    const auto least = [](float a, float b) { return b < a ? b : a; };
    const auto most = [](float a, float b) { return a < b ? b : a; };
    return {at(light.r, 0, least, most), at(light.g, 1, least, most), at(light.b, 2, least, most)};
  }
};

}  // namespace mixrig::render
