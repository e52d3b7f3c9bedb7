// SPDX-License-Identifier: Apache-2.0
// Divides the exposure of each row of a picture into slices of time.
#pragma once

#include <vector>

namespace mixrig::studio {

/// Rows are exposed for `exposure_s` each; the middle of the last row's exposure is `readout_s`
/// after that of the first. Times are relative to mid-exposure of the frame, that of its middle.
/// An exposure shorter than a slice is taken as long as a slice.
class Shutter {
 public:
  Shutter(int rows, double exposure_s, double readout_s);

  int slices() const { return slices_; }
  /// Middle of a slice's time.
  double time_s(int slice) const;
  /// Share of a row's exposure that falls into a slice; the sum over all slices is 1.
  float weight(int row, int slice) const {
    return weights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(slices_) +
                    static_cast<std::size_t>(slice)];
  }
  /// Rows [first, end) of which a slice has a share.
  struct Rows {
    int first = 0, end = 0;
  };
  Rows rows(int slice) const;

 private:
  int rows_, slices_;
  double slice_s_, begin_s_;
  std::vector<float> weights_;
};

}  // namespace mixrig::studio
