// SPDX-License-Identifier: Apache-2.0
// Error of composited frames against truth; CONVENTIONS.md, "Measures against truth", defines each.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::measure {

/// Bits of a truth label, as in a take's truth/labels.
inline constexpr std::uint8_t kLayerMask = 3;  ///< visible layer: 0 background, 1 person, 2 virtual
inline constexpr std::uint8_t kLayerVirtual = 2;
inline constexpr std::uint8_t kTofSees = 4;       ///< the ToF camera sees the real surface
inline constexpr std::uint8_t kInSilhouette = 8;  ///< inside the virtual objects, occluded or not

/// Results of the compositor for a frame. All images of a frame, these and the truth, have one size.
struct ResultImages {
  ImageView<const Rgb8> color;            ///< composite, sRGB
  ImageView<const float> warped_depth_m;  ///< 0 unknown
  ImageView<const std::uint8_t> matte;    ///< people, 255 = all
  ImageView<const float> light;           ///< 0..1
  ImageView<const std::uint8_t> layer;    ///< visible: 0 background, 1 person, 2 virtual
};

/// Ground truth of a frame.
struct TruthImages {
  ImageView<const Rgb8> color;
  ImageView<const float> depth_m;  ///< real scene, 0 where nothing is
  ImageView<const std::uint8_t> matte;
  ImageView<const float> light;  ///< light with / light without virtual objects
  ImageView<const std::uint8_t> labels;
};

/// A sum over pixels and their number.
struct Sum {
  double value = 0;
  std::uint64_t count = 0;
  void add(double v) { value += v, ++count; }
  std::optional<double> mean() const {
    return count == 0 ? std::nullopt : std::optional(value / static_cast<double>(count));
  }
};

/// Running sums over the pixels of all frames.
struct ErrorSums {
  Sum depth_abs_m, depth_bad, band_bad, matte_square, order_wrong;
  Sum light_square, light_shadow_square, color_square;
  std::uint64_t key_intersection = 0, key_union = 0;
};

/// The measures; nullopt where no pixel could be judged.
struct Errors {
  std::optional<double> depth_mae_mm, depth_bad_pct, band_bad_pct, key_iou, matte_mse;
  std::optional<double> order_wrong_pct, light_rmse, light_shadow_rmse;
  std::optional<double> color_psnr_db;  ///< kEqualPsnr_db where not a single value differs
};
inline constexpr double kEqualPsnr_db = 100.0;

/// Adds a frame. Errors: kData where an image is missing or of another size; nothing is added then.
Result<void> add_frame(const ResultImages& result, const TruthImages& truth, ErrorSums& sums);
Errors errors_of(const ErrorSums& sums);

/// 1 within `radius_px` (Euclidean, between pixel centres) of a pixel at a depth step: one whose
/// known z differs from that of a 4-neighbour by more than `step_m`. Else 0.
Image<std::uint8_t> step_band(ImageView<const float> depth_m, float step_m, int radius_px);

}  // namespace mixrig::measure
