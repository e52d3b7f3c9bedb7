// SPDX-License-Identifier: Apache-2.0
// Plain composites, whose errors are shown beside the compositor's: without its passes, and without
// error from the same plates. Shares nothing with the compositor.
#pragma once

#include <array>
#include <cstdint>

#include "hal/base/image.h"
#include "host/judge/measure/errors.h"

namespace mixrig::measure {

enum class Baseline {
  kPlate,     ///< the camera's picture as it is
  kPasted,    ///< the virtual objects on top of it: no occlusion, no shadow
  kDepthKey,  ///< people by a depth step alone, at the depth camera's resolution; no shadow
  kIdeal,     ///< true objects, occlusion and shadows on the camera's picture
};
inline constexpr std::array kBaselines{Baseline::kPlate, Baseline::kPasted, Baseline::kDepthKey,
                                       Baseline::kIdeal};
/// "plate", "pasted", "depth_key", "ideal".
const char* name(Baseline baseline);

/// Depth step of the depth key: max(kLeastStep_m, kStepSigmas sigma(z)), where sigma(z) = floor +
/// linear z + quadratic z^2 is the spread of one depth value.
inline constexpr double kLeastStep_m = 0.05, kStepSigmas = 4.0;
struct DepthSpread {
  double floor_m = 0, linear = 0, quadratic_per_m = 0;
};

/// Input of plain composites: images of one size, in the view.
struct PlainInputs {
  ImageView<const Rgb8> plate;
  ImageView<const Rgb8> object;            ///< virtual objects over black, sRGB
  ImageView<const std::uint8_t> coverage;  ///< coverage by the objects, 255 = all
  ImageView<const float> object_depth_m;   ///< z of the objects; 0 where there are none
  ImageView<const float> depth_m;          ///< z measured by the depth camera, 0 unknown
  ImageView<const float> background_m;     ///< z of the room without people, 0 unknown
};

/// Images for add_frame().
struct PlainComposite {
  Image<Rgb8> color;
  Image<float> warped_depth_m, light;
  Image<std::uint8_t> matte, layer;
  ResultImages view() const { return {color, warped_depth_m, matte, light, layer}; }
};

/// Makes kPlate, kPasted or kDepthKey. The depth key takes a pixel for a person where both depths
/// are known and it is nearer than the background by more than the step. People and background hide
/// the object where they are nearer by more than 2 cm, since the background is noisy where the
/// object stands on it. Light is 1.
void compose_plainly(Baseline baseline, const PlainInputs& inputs, const DepthSpread& spread,
                     PlainComposite& out);

/// Makes kIdeal: the true colour where an object is visible, else the plate times the true light.
/// Its colour error is the camera's noise, blur and exposure. Precondition: all images have one
/// size.
void compose_ideally(ImageView<const Rgb8> plate, const TruthImages& truth, PlainComposite& out);

}  // namespace mixrig::measure
