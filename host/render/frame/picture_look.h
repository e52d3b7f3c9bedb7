// SPDX-License-Identifier: Apache-2.0
// What a camera does to real things, measured in a plate as it is seen in the view: noise and
// width of edges; and what makes virtual things alike. Shared by both back ends.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Noise of a picture in linear light: its variance is floor + slope * light, a channel each.
struct Grain {
  glm::vec3 floor{0}, slope{0};  ///< not negative; 0, 0: none
  /// Noise of neighbours is alike: as white noise after the taps (spread, 1 - 2 spread, spread)
  /// along x and y. 0 to 1/3.
  float spread = 0;
  float shared = 0;  ///< correlation of the channels, 0 to 1
  bool operator==(const Grain&) const = default;
  bool any() const { return floor != glm::vec3(0) || slope != glm::vec3(0); }
};

struct PictureLook {
  Grain grain;
  float blur_px = 0;  ///< sigma by which edges are wider than those of a virtual object
  /// Sigma along x and y by which edges of colour differences are wider than those of brightness.
  glm::vec2 chroma_px{0};
  float sharpening = 0;  ///< s of the mask (-s, 1 + 2 s, -s) along each axis, after the blur
  bool filters() const {
    return blur_px > 0 || chroma_px.x > 0 || chroma_px.y > 0 || sharpening > 0;
  }
  bool operator==(const PictureLook&) const = default;
};
/// What of it is wanted; the rest is 0.
PictureLook wanted_of(const PictureLook& look, const LookSettings& wanted);
/// One line for the log.
std::string to_text(const PictureLook& look);

/// Weights of a pixel itself, and of those 1 and 2 beside it; their sum to both sides is 1.
using LookTaps = std::array<float, kBlurReach + 1>;

/// What makes virtual things as sharp as the plate: taps along x and y of brightness and coverage,
/// and of colour differences.
struct LookFilter {
  LookTaps light, chroma_x, chroma_y;
};
LookFilter look_filter(const PictureLook& look);

/// Linear colour as brightness, red and blue less brightness, and what lies in alpha.
inline glm::vec4 to_differences(const glm::vec4& c) {
  const float y = luminance(glm::vec3(c));
  return {y, c.r - y, c.b - y, c.a};
}
/// Back; a negative colour becomes 0, and colour over `most_alpha` of coverage is scaled with it.
glm::vec4 from_differences(const glm::vec4& d, float most_alpha);

/// Of a picture in linear light, in which blocks of `block` pixels lie one below the other. Pure.
/// Noise: the lower third of the blocks of a brightness, so that texture does not count
/// (Immerkaer 1996, at two scales). Width: the median of isolated steps along x and y, of
/// brightness and of colour differences; where it is less than that of virtual objects, the picture
/// is sharpened. What there are too few blocks or steps for stays as it was `before`.
PictureLook measure_look(const Image<glm::vec3>& blocks, Size block,
                         const PictureLook& before = {});

/// Looks at blocks of the view that are spread over it. Not thread-safe.
class LookMeter {
 public:
  /// Of the setup's view through its lens.
  explicit LookMeter(const CompositorSetup& setup);
  /// Allocates. What cannot be told from this plate stays as it was `before`.
  PictureLook measure(ImageView<const Rgb8> plate, const PictureLook& before = {});

 private:
  Image<glm::vec2> plate_px_;  ///< the blocks one below the other
  Image<glm::vec3> light_;     ///< of the plate there
};

/// Of a compositor's first plate; told in the log.
PictureLook measured_first(LookMeter& meter, ImageView<const Rgb8> plate);

/// Noise of sigma 1, as Grain says how it is alike: value * kGrainSigmas / 127. Repeats; always the
/// same.
Image<PackedNormal> make_grain(const Grain& grain);
/// Where the grain of a frame begins: anywhere in the picture of make_grain().
glm::ivec2 grain_offset(std::uint32_t frame);

/// Of a Gaussian.
LookTaps blur_taps(float sigma_px);

}  // namespace mixrig::render
