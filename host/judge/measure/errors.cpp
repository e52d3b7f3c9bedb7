// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/errors.h"

#include <cmath>
#include <string>

#include "host/judge/measure/band.h"
#include "host/judge/measure/srgb.h"

namespace mixrig::measure {
namespace {

constexpr float kBad_m = 0.1F;

std::string text(Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

Result<void> check_sizes(const ResultImages& r, const TruthImages& t) {
  const Size expected = t.labels.size;
  for (Size size : {r.color.size, r.warped_depth_m.size, r.matte.size, r.light.size, r.layer.size,
                    t.color.size, t.depth_m.size, t.matte.size, t.light.size,
                    r.mixed_depth_m.size.empty() ? expected : r.mixed_depth_m.size})
    if (size != expected || expected.empty())
      return Error{ErrorCode::kData, "truth and composite disagree in size: " + text(expected) +
                                         " against " + text(size) +
                                         ": composite in the view that the truth was made for"};
  return {};
}

/// Squared difference of two colours, summed over the channels.
int color_square(Rgb8 a, Rgb8 b) {
  const int dr = a.r - b.r, dg = a.g - b.g, db = a.b - b.b;
  return dr * dr + dg * dg + db * db;
}

void add_depth(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  const Image<std::uint8_t> band = step_band(t.depth_m, kBad_m, kBand_px);
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      const float z = r.warped_depth_m.row(y)[x];
      const float true_z = t.depth_m.row(y)[x];
      if (!is_known(true_z)) continue;
      const float error_m = std::abs(z - true_z);
      const bool hidden = (t.labels.row(y)[x] & kTofSees) == 0;
      sums.hidden_share.add(hidden ? 1.0 : 0.0);
      if (hidden) {
        sums.hidden_bad.add(!is_known(z) || error_m > kBad_m ? 1.0 : 0.0);
        sums.hidden_wrong.add(is_known(z) && error_m > kBad_m ? 1.0 : 0.0);
        continue;
      }
      if (is_known(z)) sums.depth_abs_m.add(error_m);
      const bool bad = !is_known(z) || error_m > kBad_m;
      sums.depth_bad.add(bad ? 1.0 : 0.0);
      if (band.row(y)[x] != 0) sums.band_bad.add(bad ? 1.0 : 0.0);
    }
  }
}

/// Adds errors of the mixed depth where composite and truth both show the real scene.
void add_mixed_depth(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  if (r.mixed_depth_m.size.empty()) return;
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      const std::uint8_t label = t.labels.row(y)[x];
      const float z = r.mixed_depth_m.row(y)[x], true_z = t.depth_m.row(y)[x];
      if (!is_known(true_z) || (label & kLayerMask) == kLayerVirtual ||
          r.layer.row(y)[x] == kLayerVirtual)
        continue;
      const bool off = std::abs(z - true_z) > kBad_m;
      sums.mixed_bad.add(!is_known(z) || off ? 1.0 : 0.0);
      if ((label & kTofSees) == 0) sums.mixed_hidden_wrong.add(is_known(z) && off ? 1.0 : 0.0);
    }
  }
}

void add_order(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      const std::uint8_t layer = r.layer.row(y)[x];
      const std::uint8_t label = t.labels.row(y)[x];
      if (layer == kLayerVirtual || (label & kInSilhouette) != 0)
        sums.order_wrong.add(layer != (label & kLayerMask) ? 1.0 : 0.0);
    }
  }
}

/// Matte, key, light and colour of a pixel.
void add_pixel(const ResultImages& r, const TruthImages& t, int x, int y, PixelSums& sums) {
  const int a = r.matte.row(y)[x], b = t.matte.row(y)[x];
  sums.key_intersection += a >= kHalfMatte && b >= kHalfMatte;
  sums.key_union += a >= kHalfMatte || b >= kHalfMatte;
  const double difference = (a - b) / 255.0;
  sums.matte_square.add(difference * difference);
  sums.color_square.value += color_square(r.color.row(y)[x], t.color.row(y)[x]);
  sums.color_square.count += 3;
  if ((t.labels.row(y)[x] & kLayerMask) == kLayerVirtual) return;
  const double light = static_cast<double>(r.light.row(y)[x]) - t.light.row(y)[x];
  sums.light_square.add(light * light);
}

void add_pixels(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  const Image<std::uint8_t> can_be_wrong = contested(t);
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      add_pixel(r, t, x, y, sums.all);
      const bool counts = can_be_wrong.row(y)[x] != 0;
      sums.contested_share.add(counts ? 1.0 : 0.0);
      if (counts) add_pixel(r, t, x, y, sums.contested);
    }
  }
}

void add_shadow(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      const float light = r.light.row(y)[x], true_light = t.light.row(y)[x];
      if ((t.labels.row(y)[x] & kLayerMask) == kLayerVirtual ||
          (light >= kInShadow && true_light >= kInShadow))
        continue;
      sums.light_shadow_square.add((light - true_light) * (light - true_light));
    }
  }
}

void add_object(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      if ((t.labels.row(y)[x] & kLayerMask) != kLayerVirtual || r.layer.row(y)[x] != kLayerVirtual)
        continue;
      const Rgb8 a = r.color.row(y)[x], b = t.color.row(y)[x];
      sums.object_square.value += color_square(a, b);
      sums.object_square.count += 3;
      for (const float d : {linear_of(a.r) - linear_of(b.r), linear_of(a.g) - linear_of(b.g),
                            linear_of(a.b) - linear_of(b.b)})
        sums.object_linear_square.add(static_cast<double>(d) * d);
    }
  }
}

std::optional<double> scaled(std::optional<double> value, double factor) {
  return value ? std::optional(*value * factor) : std::nullopt;
}
std::optional<double> root(std::optional<double> value) {
  return value ? std::optional(std::sqrt(*value)) : std::nullopt;
}

std::optional<double> psnr_db(const Sum& square) {
  const auto mse = square.mean();
  if (!mse) return std::nullopt;
  if (*mse <= 0.0) return kEqualPsnr_db;
  return std::min(kEqualPsnr_db, 10.0 * std::log10(255.0 * 255.0 / *mse));
}
std::optional<double> iou(const PixelSums& sums) {
  if (sums.key_union == 0) return std::nullopt;
  return static_cast<double>(sums.key_intersection) / static_cast<double>(sums.key_union);
}

}  // namespace

Image<std::uint8_t> contested(const TruthImages& truth) {
  Image<std::uint8_t> out = matte_band(truth.matte, kBand_px);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out.row(y)[x] |=
          (truth.labels.row(y)[x] & kInSilhouette) != 0 || truth.light.row(y)[x] < kInShadow;
  return out;
}

Result<void> add_frame(const ResultImages& result, const TruthImages& truth, ErrorSums& sums) {
  MIXRIG_TRY(check_sizes(result, truth));
  add_depth(result, truth, sums);
  add_mixed_depth(result, truth, sums);
  add_order(result, truth, sums);
  add_shadow(result, truth, sums);
  add_object(result, truth, sums);
  add_pixels(result, truth, sums);
  return {};
}

Errors errors_of(const ErrorSums& sums) {
  Errors e;
  e.depth_mae_mm = scaled(sums.depth_abs_m.mean(), 1e3);
  e.depth_bad_pct = scaled(sums.depth_bad.mean(), 100.0);
  e.band_bad_pct = scaled(sums.band_bad.mean(), 100.0);
  e.hidden_pct = scaled(sums.hidden_share.mean(), 100.0);
  e.hidden_bad_pct = scaled(sums.hidden_bad.mean(), 100.0);
  e.hidden_wrong_pct = scaled(sums.hidden_wrong.mean(), 100.0);
  e.mixed_bad_pct = scaled(sums.mixed_bad.mean(), 100.0);
  e.mixed_hidden_wrong_pct = scaled(sums.mixed_hidden_wrong.mean(), 100.0);
  e.key_iou = iou(sums.all);
  e.matte_mse = sums.all.matte_square.mean();
  e.order_wrong_pct = scaled(sums.order_wrong.mean(), 100.0);
  e.light_rmse = root(sums.all.light_square.mean());
  e.light_shadow_rmse = root(sums.light_shadow_square.mean());
  e.color_psnr_db = psnr_db(sums.all.color_square);
  e.object_rmse = root(sums.object_linear_square.mean());
  e.object_psnr_db = psnr_db(sums.object_square);
  e.contested.pixels_pct = scaled(sums.contested_share.mean(), 100.0);
  e.contested.key_iou = iou(sums.contested);
  e.contested.matte_mse = sums.contested.matte_square.mean();
  e.contested.light_rmse = root(sums.contested.light_square.mean());
  e.contested.color_psnr_db = psnr_db(sums.contested.color_square);
  return e;
}

}  // namespace mixrig::measure
