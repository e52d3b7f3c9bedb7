// SPDX-License-Identifier: Apache-2.0
#include "host/measure/errors.h"

#include <cmath>
#include <string>

namespace mixrig::measure {
namespace {

constexpr float kBad_m = 0.1F;
constexpr int kBand_px = 8;
constexpr float kInShadow = 0.98F;
constexpr int kHalfMatte = 128;

bool known(float z_m) { return std::isfinite(z_m) && z_m > 0.0F; }

std::string text(Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

Result<void> check_sizes(const ResultImages& r, const TruthImages& t) {
  const Size expected = t.labels.size;
  for (Size size : {r.color.size, r.warped_depth_m.size, r.matte.size, r.light.size, r.layer.size,
                    t.color.size, t.depth_m.size, t.matte.size, t.light.size})
    if (size != expected || expected.empty())
      return Error{ErrorCode::kData, "truth and composite disagree in size: " + text(expected) +
                                         " against " + text(size) +
                                         ": composite in the view that the truth was made for"};
  return {};
}

void add_depth(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  const Image<std::uint8_t> band = step_band(t.depth_m, kBad_m, kBand_px);
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      const float z = r.warped_depth_m.row(y)[x];
      const float true_z = t.depth_m.row(y)[x];
      if ((t.labels.row(y)[x] & kTofSees) == 0 || !known(true_z)) continue;
      const float error_m = std::abs(z - true_z);
      if (known(z)) sums.depth_abs_m.add(error_m);
      const bool bad = !known(z) || error_m > kBad_m;
      sums.depth_bad.add(bad ? 1.0 : 0.0);
      if (band.row(y)[x] != 0) sums.band_bad.add(bad ? 1.0 : 0.0);
    }
  }
}

void add_key(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      const int a = r.matte.row(y)[x];
      const int b = t.matte.row(y)[x];
      sums.key_intersection += a >= kHalfMatte && b >= kHalfMatte;
      sums.key_union += a >= kHalfMatte || b >= kHalfMatte;
      const double difference = (a - b) / 255.0;
      sums.matte_square.add(difference * difference);
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

void add_light(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  for (int y = 0; y < t.labels.size.height; ++y) {
    for (int x = 0; x < t.labels.size.width; ++x) {
      if ((t.labels.row(y)[x] & kLayerMask) == kLayerVirtual) continue;
      const float light = r.light.row(y)[x];
      const float true_light = t.light.row(y)[x];
      const double square = (light - true_light) * (light - true_light);
      sums.light_square.add(square);
      if (light < kInShadow || true_light < kInShadow) sums.light_shadow_square.add(square);
    }
  }
}

void add_color(const ResultImages& r, const TruthImages& t, ErrorSums& sums) {
  for (int y = 0; y < t.labels.size.height; ++y) {
    std::uint64_t row_sum = 0;
    for (int x = 0; x < t.labels.size.width; ++x) {
      const Rgb8 a = r.color.row(y)[x];
      const Rgb8 b = t.color.row(y)[x];
      const int dr = a.r - b.r, dg = a.g - b.g, db = a.b - b.b;
      row_sum += static_cast<std::uint64_t>(dr * dr + dg * dg + db * db);
    }
    sums.color_square.value += static_cast<double>(row_sum);
    sums.color_square.count += 3U * static_cast<std::uint64_t>(t.labels.size.width);
  }
}

/// Marks both pixels of every neighbouring pair whose known depths differ by more than step_m.
Image<std::uint8_t> steps(ImageView<const float> depth_m, float step_m) {
  const auto [width, height] = depth_m.size;
  Image<std::uint8_t> marks(depth_m.size);
  const auto compare = [&](int xa, int ya, int xb, int yb) {
    const float a = depth_m.row(ya)[xa], b = depth_m.row(yb)[xb];
    if (known(a) && known(b) && std::abs(a - b) > step_m) marks.row(ya)[xa] = marks.row(yb)[xb] = 1;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) compare(x, y, x + 1, y);
      if (y + 1 < height) compare(x, y, x, y + 1);
    }
  }
  return marks;
}

std::optional<double> scaled(std::optional<double> value, double factor) {
  return value ? std::optional(*value * factor) : std::nullopt;
}
std::optional<double> root(std::optional<double> value) {
  return value ? std::optional(std::sqrt(*value)) : std::nullopt;
}

}  // namespace

Image<std::uint8_t> step_band(ImageView<const float> depth_m, float step_m, int radius_px) {
  const auto [width, height] = depth_m.size;
  // Vertical distance to the nearest mark of the column first, then the disc column by column.
  Image<std::uint8_t> marks = steps(depth_m, step_m);
  Image<int> vertical_px(depth_m.size, radius_px + 1);
  for (int x = 0; x < width; ++x) {
    int distance = radius_px + 1;
    for (int y = 0; y < height; ++y) {
      distance = marks.row(y)[x] != 0 ? 0 : std::min(distance + 1, radius_px + 1);
      vertical_px.row(y)[x] = distance;
    }
    distance = radius_px + 1;
    for (int y = height - 1; y >= 0; --y) {
      distance = marks.row(y)[x] != 0 ? 0 : std::min(distance + 1, radius_px + 1);
      vertical_px.row(y)[x] = std::min(vertical_px.row(y)[x], distance);
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint8_t inside = 0;
      for (int u = std::max(0, x - radius_px); u <= std::min(width - 1, x + radius_px); ++u) {
        const int dy = vertical_px.row(y)[u];
        inside |= (u - x) * (u - x) + dy * dy <= radius_px * radius_px;
      }
      marks.row(y)[x] = inside;
    }
  }
  return marks;
}

Result<void> add_frame(const ResultImages& result, const TruthImages& truth, ErrorSums& sums) {
  MIXRIG_TRY(check_sizes(result, truth));
  add_depth(result, truth, sums);
  add_key(result, truth, sums);
  add_order(result, truth, sums);
  add_light(result, truth, sums);
  add_color(result, truth, sums);
  return {};
}

Errors errors_of(const ErrorSums& sums) {
  Errors e;
  e.depth_mae_mm = scaled(sums.depth_abs_m.mean(), 1e3);
  e.depth_bad_pct = scaled(sums.depth_bad.mean(), 100.0);
  e.band_bad_pct = scaled(sums.band_bad.mean(), 100.0);
  if (sums.key_union != 0)
    e.key_iou = static_cast<double>(sums.key_intersection) / static_cast<double>(sums.key_union);
  e.matte_mse = sums.matte_square.mean();
  e.order_wrong_pct = scaled(sums.order_wrong.mean(), 100.0);
  e.light_rmse = root(sums.light_square.mean());
  e.light_shadow_rmse = root(sums.light_shadow_square.mean());
  if (const auto mse = sums.color_square.mean())
    e.color_psnr_db = *mse > 0.0 ? std::min(kEqualPsnr_db, 10.0 * std::log10(255.0 * 255.0 / *mse))
                                 : kEqualPsnr_db;
  return e;
}

}  // namespace mixrig::measure
