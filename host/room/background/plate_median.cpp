// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/plate_median.h"

#include <algorithm>
#include <array>
#include <span>

namespace mixrig::model {
namespace {

constexpr int kMedianGrain = 16;

const std::uint8_t* bytes_of(const Image<Rgb8>& plate, int y) {
  return reinterpret_cast<const std::uint8_t*>(plate.row(y));
}

/// Median of three or four values: the mean without the least and the largest.
void trim_row(std::span<const Image<Rgb8>> plates, int y, int bytes, std::uint8_t* to) {
  const int kept = static_cast<int>(plates.size()) - 2;
  std::array<const std::uint8_t*, 4> from{};
  for (std::size_t i = 0; i < plates.size(); ++i) from[i] = bytes_of(plates[i], y);
  for (int i = 0; i < bytes; ++i) {
    const int a = from[0][i], b = from[1][i], c = from[2][i];
    int sum = a + b + c, least = std::min({a, b, c}), most = std::max({a, b, c});
    if (from[3] != nullptr) {
      const int d = from[3][i];
      sum += d, least = std::min(least, d), most = std::max(most, d);
    }
    to[i] = static_cast<std::uint8_t>((sum - least - most + kept / 2) / kept);
  }
}

void median_row(std::span<const Image<Rgb8>> plates, int y, int bytes, std::uint8_t* to) {
  std::array<std::uint8_t, PlateMedian::kMostPlates> values{};
  const auto end = values.begin() + static_cast<std::ptrdiff_t>(plates.size());
  const std::size_t half = plates.size() / 2;
  for (int i = 0; i < bytes; ++i) {
    for (std::size_t k = 0; k < plates.size(); ++k) values[k] = bytes_of(plates[k], y)[i];
    std::nth_element(values.begin(), values.begin() + half, end);
    int middle = values[half];
    if (plates.size() % 2 == 0)
      middle = (middle + *std::max_element(values.begin(), values.begin() + half) + 1) / 2;
    to[i] = static_cast<std::uint8_t>(middle);
  }
}

}  // namespace

void PlateMedian::add(ImageView<const Rgb8> plate) {
  if (count_ == kMostPlates) return;
  if (count_ == plates_.size()) plates_.emplace_back();
  Image<Rgb8>& kept = plates_[count_++];
  if (kept.size() != plate.size) kept.reset(plate.size);
  for (int y = 0; y < plate.size.height; ++y)
    std::copy_n(plate.row(y), plate.size.width, kept.row(y));
}

void PlateMedian::finish(Image<Rgb8>& plate, Crew& crew) const {
  if (count_ == 0) return plate.reset({});
  const std::span plates(plates_.data(), count_);
  if (count_ <= 2) {
    plate = plates[0];
    return;
  }
  plate.reset(plates[0].size());
  const int bytes = 3 * plate.width();
  crew.rows(plate.height(), kMedianGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      auto* to = reinterpret_cast<std::uint8_t*>(plate.row(y));
      count_ <= 4 ? trim_row(plates, y, bytes, to) : median_row(plates, y, bytes, to);
    }
  });
}

}  // namespace mixrig::model
