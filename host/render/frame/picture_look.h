// SPDX-License-Identifier: Apache-2.0
// How a camera changes real things, measured in a plate as seen in the view: noise, width of
// edges. Shared by both back ends.
#pragma once

#include <string>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Noise of a picture in linear light: for each channel its variance is floor + slope * light.
struct Grain {
  glm::vec3 floor{0}, slope{0};  ///< not negative; 0, 0: no noise
  /// Correlation of neighbouring pixels: that of white noise after the taps (spread, 1 - 2 spread,
  /// spread) along x and y. 0 to 1/3.
  float spread = 0;
  float shared = 0;  ///< correlation between the channels, 0 to 1
  bool operator==(const Grain&) const = default;
  bool any() const { return floor != glm::vec3(0) || slope != glm::vec3(0); }
};

struct PictureLook {
  Grain grain;
  float blur_px = 0;  ///< sigma by which edges are wider than a virtual object's
  /// Sigma along x and y by which edges of colour differences are wider than those of brightness.
  glm::vec2 chroma_px{0};
  float sharpening = 0;  ///< s of the mask (-s, 1 + 2 s, -s) along each axis, after the blur
  bool filters() const {
    return blur_px > 0 || chroma_px.x > 0 || chroma_px.y > 0 || sharpening > 0;
  }
  bool operator==(const PictureLook&) const = default;
};
/// Keeps the properties that are wanted and sets the others to 0.
PictureLook wanted_of(const PictureLook& look, const LookSettings& wanted);
/// Describes a look in one line for the log.
std::string to_text(const PictureLook& look);

/// Measures the look of a picture in linear light, in which blocks of `block` pixels lie one below
/// the other. Noise is taken from the smoothest third of the blocks of each brightness, so that
/// texture does not count (Immerkaer 1996, at two scales). Edge width is the median of isolated
/// steps along x and y, in brightness and in colour differences; narrower than a virtual object's
/// means sharpening. With too few blocks or steps a property stays as in `before`. Pure.
PictureLook measure_look(const Image<glm::vec3>& blocks, Size block,
                         const PictureLook& before = {});

/// Measures the look of plates by blocks spread over the view. Not thread-safe.
class LookMeter {
 public:
  /// Reads view and lens of the setup.
  explicit LookMeter(const CompositorSetup& setup);
  /// Measures a plate; properties that it does not show stay as in `before`. Allocates.
  PictureLook measure(ImageView<const Rgb8> plate, const PictureLook& before = {});

 private:
  Image<glm::vec2> plate_px_;  ///< plate pixels of the blocks, one below the other
  Image<glm::vec3> light_;     ///< linear light of the plate at plate_px_
};

/// Measures a compositor's first plate and logs the result.
PictureLook measured_first(LookMeter& meter, ImageView<const Rgb8> plate);

}  // namespace mixrig::render
