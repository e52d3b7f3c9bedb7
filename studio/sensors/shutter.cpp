// SPDX-License-Identifier: Apache-2.0
// Divides the exposure of each row of a picture into slices of time.
#include "studio/sensors/shutter.h"

#include <algorithm>
#include <cmath>

namespace mixrig::studio {
namespace {

constexpr double kLongest_s = 2e-3;  ///< of a slice: a hand at 4 m/s moves 8 mm in it

}  // namespace

Shutter::Shutter(int rows, double exposure_s, double readout_s)
    : rows_(rows),
      slices_(std::max(1, static_cast<int>(std::ceil((exposure_s + readout_s) / kLongest_s)))),
      slice_s_((exposure_s + readout_s) / slices_),
      begin_s_(-0.5 * (exposure_s + readout_s)),
      weights_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(slices_)) {
  const double width = std::max(exposure_s, slice_s_);
  for (int y = 0; y < rows; ++y) {
    const double share = rows > 1 ? static_cast<double>(y) / (rows - 1) - 0.5 : 0;
    const double from = share * readout_s - 0.5 * width, to = from + width;
    float* weight = &weights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(slices_)];
    double sum = 0;
    for (int i = 0; i < slices_; ++i) {
      const double begin = begin_s_ + i * slice_s_;
      const double overlap = std::min(to, begin + slice_s_) - std::max(from, begin);
      weight[i] = static_cast<float>(std::max(overlap, 0.0));
      sum += weight[i];
    }
    if (sum <= 0) weight[0] = 1, sum = 1;  // neither exposure nor readout: one instant
    for (int i = 0; i < slices_; ++i) weight[i] = static_cast<float>(weight[i] / sum);
  }
}

double Shutter::time_s(int slice) const { return begin_s_ + (slice + 0.5) * slice_s_; }

Shutter::Rows Shutter::rows(int slice) const {
  Rows range{rows_, 0};
  for (int y = 0; y < rows_; ++y)
    if (weight(y, slice) > 0) range = {std::min(range.first, y), y + 1};
  return range;
}

}  // namespace mixrig::studio
