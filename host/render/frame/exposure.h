// SPDX-License-Identifier: Apache-2.0
// Measures how the camera's exposure differs from that of the learned background.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/render/contract/tone_curve.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Compares a sparse grid of plate pixels with the learned background, since cameras change
/// exposure and white balance automatically: a person in dark clothes brightens the whole room.
/// Shared by both back ends. Not thread-safe.
class ExposureMeter {
 public:
  /// A view pixel at which background and plate are compared.
  struct Place {
    int view_x = 0, view_y = 0;
    int plate_x = 0, plate_y = 0;  ///< negative: outside the plate
    float gain = 1;                ///< factor of the plate's light (Tables::plate_gain)
  };
  /// Reads `tables.plate_px` and `plate_gain` in the constructor, so they may be released
  /// afterwards.
  ExposureMeter(const Tables& tables, const BackgroundView& background);
  std::span<const Place> places() const { return grid_; }
  /// Takes lens and view of `setup`; call it before learn(). The places keep their view pixels.
  void see_through(const CompositorSetup& setup);
  /// Takes another background of the same size. Allocates nothing.
  void learn(const BackgroundView& background);
  /// Takes the learned linear colours of places(), in their order.
  void learn(std::span<const glm::vec4> colors);
  /// Gain per channel, plate = gain * learned in linear light, within 1/8 and 8: from the densest
  /// third of the samples' ratios, so that people may fill up to two thirds of the picture. 1 if
  /// too few pixels are usable. Allocates nothing.
  glm::vec3 gain(ImageView<const Rgb8> plate);
  /// Tone curve: the gain, refined around each knot by the densest third of the places of that
  /// brightness. A knot is off the gain by no more than the gain is off 1, less 4 %, so that noise
  /// and people bend nothing while the exposure stays. Allocates nothing.
  ToneCurve curve(ImageView<const Rgb8> plate);
  /// Tone curve by an undecoded plate: only single pixels of it are decoded.
  ToneCurve curve(const RawPicture& plate);

 private:
  struct Sample {
    int x = 0, y = 0;      ///< plate pixel
    float gain = 1;        ///< factor of its light
    glm::vec3 learned{0};  ///< linear
  };
  struct Ratio {
    float log_luminance = 0;
    glm::vec3 plate{0}, learned{0};
  };
  /// Sums over the shortest interval of luminance ratios that holds a third of `ratios_`.
  Ratio densest_third();
  /// Ratio of the camera's gain around a knot to `gain`; none if too few places have that
  /// brightness.
  std::optional<glm::vec3> around_knot(float knot, const glm::vec3& gain);
  glm::vec3 gain_of_seen();
  ToneCurve curve_of_seen();
  std::vector<Place> grid_;
  std::vector<Sample> samples_;
  std::vector<glm::vec3> seen_;  ///< linear light of the samples in the plate
  std::vector<Ratio> ratios_;
  /// Logarithms of `ratios_`, with their indices.
  std::vector<std::pair<float, std::uint32_t>> order_;
};

}  // namespace mixrig::render
