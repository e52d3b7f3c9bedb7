// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/sweep/picture_shift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace mixrig::live {
namespace {

constexpr int kBlockColumns = 8, kBlockRows = 6, kFewestPixels = 40;
constexpr double kSigmas = 3.5, kOutOfNoise = 4;

/// Sums of the normal equations of one block.
struct ShiftSums {
  double xx = 0, xy = 0, yy = 0, xe = 0, ye = 0, ee = 0;
  int count = 0;
};

/// An estimate along one axis.
struct AxisShift {
  double px = 0, weight = 0;
};

/// Central differences of the mean picture; false where a value is unknown.
bool gradient_at(ImageView<const float> a, ImageView<const float> b, int x, int y, double& gx,
                 double& gy, double& e) {
  const std::array<float, 10> v{a.row(y)[x],     b.row(y)[x],     a.row(y)[x - 1], a.row(y)[x + 1],
                                b.row(y)[x - 1], b.row(y)[x + 1], a.row(y - 1)[x], a.row(y + 1)[x],
                                b.row(y - 1)[x], b.row(y + 1)[x]};
  if (!std::all_of(v.begin(), v.end(), [](float value) { return value > 0; })) return false;
  gx = 0.25 * (v[3] - v[2] + v[5] - v[4]);
  gy = 0.25 * (v[7] - v[6] + v[9] - v[8]);
  e = v[1] - v[0];
  return true;
}

ShiftSums sums_of(ImageView<const float> a, ImageView<const float> b, int x0, int x1, int y0,
                  int y1) {
  ShiftSums s;
  double gx = 0, gy = 0, e = 0;
  for (int y = std::max(y0, 1); y < std::min(y1, a.size.height - 1); ++y)
    for (int x = std::max(x0, 1); x < std::min(x1, a.size.width - 1); ++x) {
      if (!gradient_at(a, b, x, y, gx, gy, e)) continue;
      s.xx += gx * gx, s.xy += gx * gy, s.yy += gy * gy;
      s.xe += gx * e, s.ye += gy * e, s.ee += e * e;
      ++s.count;
    }
  return s;
}

/// Solves one block. b(p) = a(p - s), so e = -g s. The gradient of noise of variance v has a
/// variance of v / 8: that of e is 2 v, and four samples are averaged with weight 1/4.
void solve_block(const ShiftSums& s, std::vector<AxisShift>& along_x,
                 std::vector<AxisShift>& along_y) {
  const double det = s.xx * s.yy - s.xy * s.xy;
  if (s.count < kFewestPixels || !(det > 1e-9 * s.xx * s.yy)) return;
  const double x = -(s.yy * s.xe - s.xy * s.ye) / det, y = -(s.xx * s.ye - s.xy * s.xe) / det;
  const double least = 1e-6 * s.count;  // floor for equal pictures
  const double squares = std::max(least, s.ee + x * s.xe + y * s.ye);
  const double variance = squares / std::max(1, s.count - 2);
  const double noise = kOutOfNoise * s.count * variance / 8;
  if (s.xx > noise) along_x.push_back({x, det / (s.yy * variance)});
  if (s.yy > noise) along_y.push_back({y, det / (s.xx * variance)});
}

void weighted_median(std::vector<AxisShift>& shifts, double& px, double& sigma_px) {
  if (shifts.empty()) return;
  std::sort(shifts.begin(), shifts.end(),
            [](const AxisShift& a, const AxisShift& b) { return a.px < b.px; });
  double sum = 0, below = 0;
  for (const AxisShift& shift : shifts) sum += shift.weight;
  for (const AxisShift& shift : shifts) {
    px = shift.px;
    below += shift.weight;
    if (below >= 0.5 * sum) break;
  }
  sigma_px = 1.25 / std::sqrt(sum);  // sigma of the median of normal values
}

}  // namespace

bool PictureShift::is_none(double least_px) const {
  return std::abs(x_px) <= std::max(least_px, kSigmas * sigma_x_px) &&
         std::abs(y_px) <= std::max(least_px, kSigmas * sigma_y_px);
}

double PictureShift::length_px() const { return std::hypot(x_px, y_px); }

PictureShift shift_between(ImageView<const float> a, ImageView<const float> b) {
  PictureShift shift;
  if (a.size != b.size || a.empty()) return shift;
  std::vector<AxisShift> along_x, along_y;
  for (int row = 0; row < kBlockRows; ++row)
    for (int column = 0; column < kBlockColumns; ++column)
      solve_block(sums_of(a, b, a.size.width * column / kBlockColumns,
                          a.size.width * (column + 1) / kBlockColumns,
                          a.size.height * row / kBlockRows, a.size.height * (row + 1) / kBlockRows),
                  along_x, along_y);
  weighted_median(along_x, shift.x_px, shift.sigma_x_px);
  weighted_median(along_y, shift.y_px, shift.sigma_y_px);
  return shift;
}

void luminance_of(const Image<Rgb8>& plate, Image<float>& out) {
  if (out.size() != plate.size()) out.reset(plate.size());
  for (int y = 0; y < plate.height(); ++y)
    std::transform(plate.row(y), plate.row(y) + plate.width(), out.row(y), [](const Rgb8& p) {
      return 1 + 0.25F * static_cast<float>(p.r + 2 * p.g + p.b);
    });
}

}  // namespace mixrig::live
