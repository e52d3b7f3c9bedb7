// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/flicker.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "host/judge/measure/band.h"

namespace mixrig::measure {
namespace {

std::optional<double> root_mean(const Sum& square) {
  const auto mean = square.mean();
  return mean ? std::optional(std::sqrt(*mean)) : std::nullopt;
}

}  // namespace

void MatteFlicker::add(ImageView<const std::uint8_t> matte,
                       ImageView<const std::uint8_t> true_matte) {
  const Size size = true_matte.size;
  Image<std::uint8_t> band = matte_band(true_matte, kBand_px);
  if (matte_.size() == size) {
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        if (band.row(y)[x] == 0 || band_.row(y)[x] == 0) continue;
        const int change = matte.row(y)[x] - matte_.row(y)[x];
        const int true_change = true_matte.row(y)[x] - true_matte_.row(y)[x];
        const double off = (change - true_change) / 255.0;
        square_.add(off * off);
        if (std::abs(true_change) <= kStill) still_square_.add(change * change / (255.0 * 255.0));
      }
  }
  matte_.reset(size), true_matte_.reset(size);
  for (int y = 0; y < size.height; ++y) {
    std::copy_n(matte.row(y), size.width, matte_.row(y));
    std::copy_n(true_matte.row(y), size.width, true_matte_.row(y));
  }
  band_ = std::move(band);
}

std::optional<double> MatteFlicker::still() const { return root_mean(still_square_); }
std::optional<double> MatteFlicker::all() const { return root_mean(square_); }

}  // namespace mixrig::measure
