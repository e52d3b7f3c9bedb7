// SPDX-License-Identifier: Apache-2.0
// Error of composited frames against truth; docs/reference/measures.md defines each.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/judge/measure/band.h"

namespace mixrig::measure {

/// Bits of a truth label, as in a take's truth/labels.
inline constexpr std::uint8_t kLayerMask = 3;  ///< visible layer: 0 background, 1 person, 2 virtual
inline constexpr std::uint8_t kLayerPerson = 1, kLayerVirtual = 2;
/// Light below this value counts as shadow.
inline constexpr float kInShadow = 0.98F;
/// Width of the people's band on either side of the true border.
inline constexpr int kBand_px = 8;
inline constexpr std::uint8_t kTofSees = 4;       ///< the ToF camera sees the real surface
inline constexpr std::uint8_t kInSilhouette = 8;  ///< inside the virtual objects, occluded or not

/// Results of the compositor for a frame. All images of a frame, these and the truth, have one
/// size.
struct ResultImages {
  ImageView<const Rgb8> color;             ///< composite, sRGB
  ImageView<const float> warped_depth_m;   ///< 0 unknown
  ImageView<const std::uint8_t> matte;     ///< people, 255 = all
  ImageView<const float> light;            ///< 0..1
  ImageView<const std::uint8_t> layer;     ///< visible: 0 background, 1 person, 2 virtual
  ImageView<const float> mixed_depth_m{};  ///< of the visible layer, 0 unknown; empty: not judged
};

/// Ground truth of a frame.
struct TruthImages {
  ImageView<const Rgb8> color;
  ImageView<const float> depth_m;  ///< real scene, 0 where nothing is
  ImageView<const std::uint8_t> matte;
  ImageView<const float> light;  ///< light with virtual objects over light without them
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

/// Sums over any set of pixels: key, light and colour.
struct PixelSums {
  Sum matte_square, light_square, color_square;
  std::uint64_t key_intersection = 0, key_union = 0;
};

/// Running sums over the pixels of all frames.
struct ErrorSums {
  Sum depth_abs_m, depth_bad, band_bad, order_wrong, light_shadow_square;
  Sum hidden_share;  ///< 1 for a pixel whose surface the ToF camera does not see, else 0
  Sum hidden_bad, hidden_wrong;  ///< sums over the pixels whose surface the ToF camera does not see
  Sum mixed_bad, mixed_hidden_wrong;
  Sum object_square;         ///< sRGB values
  Sum object_linear_square;  ///< linear light, 0..1
  PixelSums all, contested;
  Sum contested_share;  ///< 1 for a contested pixel, else 0
};

/// The measures; nullopt where no pixel could be judged.
struct Errors {
  std::optional<double> depth_mae_mm, depth_bad_pct, band_bad_pct, key_iou, matte_mse;
  std::optional<double> hidden_pct, hidden_bad_pct, hidden_wrong_pct;
  std::optional<double> mixed_bad_pct, mixed_hidden_wrong_pct;
  std::optional<double> matte_flicker, matte_dtssd;  ///< MatteFlicker::still() and all()
  std::optional<double> order_wrong_pct, light_rmse, light_shadow_rmse;
  std::optional<double> color_psnr_db;  ///< kEqualPsnr_db where not a single value differs
  std::optional<double> object_rmse, object_psnr_db;
  /// Measures over contested pixels alone.
  struct Contested {
    std::optional<double> pixels_pct;  ///< share of the pixels
    std::optional<double> key_iou, matte_mse, light_rmse, color_psnr_db;
  } contested;
  /// Results of look_of(). Noise is of 255 at equal brightness; sharpness 1 equals the truth.
  struct Look {
    std::optional<double> real_noise, virtual_noise;
    std::optional<double> real_sharpness, virtual_sharpness, outline_sharpness;
  } look;
  /// Wrong pieces per frame, by ScrapJudge; `largest_px` is the largest of all frames.
  struct Scraps {
    std::optional<double> person_through_object, object_through_person, room_through, over_room;
    std::optional<double> pixels, largest_px, changed_pixels, specks, ghost_pixels;
  } scraps;
  /// Evenness and width of the silhouettes of people and of virtual objects, in the composite.
  struct Stairs {
    std::optional<double> real_off_line_px, virtual_off_line_px, real_width_px, virtual_width_px;
  } stairs;
};
inline constexpr double kEqualPsnr_db = 100.0;

/// Adds a frame. Errors: kData where an image is missing or of another size; nothing is added then.
Result<void> add_frame(const ResultImages& result, const TruthImages& truth, ErrorSums& sums);
Errors errors_of(const ErrorSums& sums);

/// Mask of the pixels that a compositor can get wrong, by the truth alone: 1 inside the silhouette
/// of the virtual objects, in their true shadow (light below kInShadow), or within kBand_px of the
/// people's border; else 0.
Image<std::uint8_t> contested(const TruthImages& truth);

}  // namespace mixrig::measure
