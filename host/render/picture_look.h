// SPDX-License-Identifier: Apache-2.0
// What a camera does to real things, measured in a plate as it is seen in the view: noise and
// width of edges; and what makes virtual things alike. Shared by both back ends.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/compositor.h"
#include "host/render/prepare.h"

namespace mixrig::render {

/// Noise of a picture in linear light: its variance is floor + slope * light, a channel each.
struct Grain {
  glm::vec3 floor{0}, slope{0};  ///< not negative; 0, 0: none
  /// Noise of neighbours is alike: as white noise after the taps (spread, 1 - 2 spread, spread)
  /// along x and y. 0 to 1/3.
  float spread = 0;
  float shared = 0;  ///< correlation of the channels, 0 to 1
};

struct PictureLook {
  Grain grain;
  float blur_px = 0;  ///< sigma by which edges are wider than those of a virtual object
};

/// Of a picture in linear light, in which blocks of `block` pixels lie one below the other. Pure.
/// Noise: the lower third of the blocks of a brightness, so that texture does not count
/// (Immerkaer 1996, at two scales). Width: the median of isolated steps along x and y.
PictureLook measure_look(const Image<glm::vec3>& blocks, Size block);

/// Looks at blocks of the view that are spread over it. Not thread-safe.
class LookMeter {
 public:
  /// Reads `tables.plate_px` now, so call it before it is given away.
  LookMeter(const Tables& tables, const LookSettings& wanted);
  /// Once, in the first frame; what is not wanted is 0. Allocates, and gives its memory back.
  PictureLook measure(ImageView<const Rgb8> plate);

 private:
  LookSettings wanted_;
  Image<glm::vec2> plate_px_;  ///< the blocks one below the other
};

/// Noise of sigma 1, as Grain says how it is alike: value * kGrainSigmas / 127. Repeats; always the
/// same.
Image<PackedNormal> make_grain(const Grain& grain);
/// Where the grain of a frame begins: anywhere in the picture of make_grain().
glm::ivec2 grain_offset(std::uint32_t frame);

/// Weights of the pixel itself, and of those 1 and 2 beside it, along each axis.
std::array<float, kBlurReach + 1> blur_taps(float sigma_px);

}  // namespace mixrig::render
