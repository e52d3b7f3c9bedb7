// SPDX-License-Identifier: Apache-2.0
// How much brighter the camera is set than when the background was learned.
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

/// Cameras change exposure and white balance automatically: a person in dark clothes brightens the
/// whole room. The meter compares a sparse grid of plate pixels with the learned background. Shared
/// by both back ends. Not thread-safe.
class ExposureMeter {
 public:
  /// Where the background is compared with the plate.
  struct Place {
    int view_x = 0, view_y = 0;
    int plate_x = 0, plate_y = 0;  ///< negative: outside of the plate
    float gain = 1;                ///< of the plate's light (Tables::plate_gain)
  };
  /// Reads `tables.plate_px` and `plate_gain` now, so call it before these are given away.
  ExposureMeter(const Tables& tables, const BackgroundView& background);
  std::span<const Place> places() const { return grid_; }
  /// Takes the lens and view of `setup`, before learn(). The places stay those of the view.
  void see_through(const CompositorSetup& setup);
  /// Takes another background of the same size. Allocates nothing.
  void learn(const BackgroundView& background);
  /// The same from the colours of places() in order.
  void learn(std::span<const glm::vec4> colors);
  /// Gain per channel, plate = gain * learned in linear light, within 1/8 and 8: the densest third
  /// of the samples' ratios, so that people may fill up to two thirds of the picture. 1 where too
  /// few pixels are usable. Allocates nothing.
  glm::vec3 gain(ImageView<const Rgb8> plate);
  /// The gain, and what places of each brightness say beside it: the densest third of those around
  /// each knot, by no more from the gain than the gain is from 1, less 4 %, so that noise and
  /// people bend nothing while the exposure stays. Allocates nothing.
  ToneCurve curve(ImageView<const Rgb8> plate);
  /// The same of a plate that is not decoded: single pixels of it are.
  ToneCurve curve(const RawPicture& plate);

 private:
  struct Sample {
    int x = 0, y = 0;      ///< plate pixel
    float gain = 1;        ///< of its light
    glm::vec3 learned{0};  ///< linear
  };
  struct Ratio {
    float log_luminance = 0;
    glm::vec3 plate{0}, learned{0};
  };
  /// Sums over the shortest interval that holds a third of `ratios_`.
  Ratio densest_third();
  /// The camera's gain around a knot over `gain`; none where too few places tell.
  std::optional<glm::vec3> around_knot(float knot, const glm::vec3& gain);
  glm::vec3 gain_of_seen();
  ToneCurve curve_of_seen();
  std::vector<Place> grid_;
  std::vector<Sample> samples_;
  std::vector<glm::vec3> seen_;  ///< linear light of the samples in the plate
  std::vector<Ratio> ratios_;
  std::vector<std::pair<float, std::uint32_t>> order_;  ///< logarithms of `ratios_`, and which
};

}  // namespace mixrig::render
