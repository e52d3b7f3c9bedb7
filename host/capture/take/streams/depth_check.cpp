// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/depth_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/capture/take/tell_once.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kLeastPixels = 100;  ///< known ones, to judge a picture by
/// Share of a picture that has one step, from which that step is told as no measurement: of the
/// largest step of all, and of the largest one of a sensor with fewer bits.
constexpr double kFewAtTheEnd = 0.005, kFewAtFewerBits = 0.02;
/// Steps next to such a one that a measured surface would also have.
constexpr double kGapBelow = 0.9;
constexpr float kNearestUsual_m = 0.25F, kFarthestUsual_m = 15.0F;
constexpr double kMostUnknown = 0.98;

}  // namespace

void DepthCheck::note(Fault fault, const std::string& what) {
  bool& told = told_[static_cast<std::size_t>(fault)];
  if (told) return;
  told = true;
  found_.push_back(where_ + ": " + what);
  tell_once(found_.back());
}

/// A step of only ones in 10 to 16 bits, far from all others, or a picture of 8 bits made to 16.
void DepthCheck::check_steps(const Image<std::uint16_t>& steps, const Steps& meaning) {
  histogram_.assign(65536, 0);
  for (int y = 0; y < steps.height(); ++y)
    for (int x = 0; x < steps.width(); ++x) ++histogram_[steps.row(y)[x]];
  const auto pixels = static_cast<double>(steps.width()) * steps.height();
  int largest = 0, second = 0, levels = 0, stretched = 0;
  for (int step = 1; step < 65536; ++step) {
    if (histogram_[static_cast<std::size_t>(step)] == 0 || meaning.is_unknown(step)) continue;
    second = largest, largest = step;
    ++levels;
    stretched += step % 257 == 0 ? 1 : 0;
  }
  if (levels >= 8 && stretched == levels)
    note(
        Fault::kStretched,
        "all its steps are multiples of 257, an 8-bit picture made to 16 bits: depth needs 16 bits "
        "from the camera on (was it converted for display?)");
  const bool only_ones = largest >= 1023 && (largest & (largest + 1)) == 0;
  const double share = histogram_[static_cast<std::size_t>(largest)] / pixels;
  const double few = largest == 65535 ? kFewAtTheEnd : kFewAtFewerBits;
  if (!only_ones || share < few || second > kGapBelow * largest) return;
  note(
      Fault::kOnes,
      fmt::format("{:.0f} % of a picture are step {}, which is read as {:.1f} m: where it means no "
                  "measurement, add it to unknown, like unknown = [{}, {}]",
                  100 * share, largest, meaning.offset + largest * meaning.unit, meaning.unknown[0],
                  largest));
}

void DepthCheck::check_range(const Image<float>& depth_m) {
  known_m_.clear();
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x)
      if (depth_m.row(y)[x] > 0) known_m_.push_back(depth_m.row(y)[x]);
  const auto pixels =
      static_cast<std::size_t>(depth_m.width()) * static_cast<std::size_t>(depth_m.height());
  if (pixels < kLeastPixels) return;
  if (static_cast<double>(known_m_.size()) < (1 - kMostUnknown) * static_cast<double>(pixels)) {
    note(Fault::kUnknown, fmt::format("{:.0f} % of a picture have no depth: is unknown right?",
                                      100 - 100.0 * static_cast<double>(known_m_.size()) /
                                                static_cast<double>(pixels)));
    return;
  }
  if (known_m_.size() < kLeastPixels) return;
  const auto at = [&](double part) {
    const auto nth = known_m_.begin() +
                     static_cast<std::ptrdiff_t>(part * static_cast<double>(known_m_.size() - 1));
    std::nth_element(known_m_.begin(), nth, known_m_.end());
    return *nth;
  };
  const float median_m = at(0.5), p95_m = at(0.95);
  if (p95_m < kNearestUsual_m)
    note(Fault::kRange,
         fmt::format(
             "95 % of a picture lie nearer than {:.2f} m (median {:.2f} m): is unit_m right?",
             kNearestUsual_m, median_m));
  else if (median_m > kFarthestUsual_m && !told_[static_cast<std::size_t>(Fault::kOnes)])
    note(Fault::kRange,
         fmt::format(
             "half of a picture lies farther than {:.0f} m (median {:.1f} m): are unit_m and "
             "unknown right?",
             kFarthestUsual_m, median_m));
}

void DepthCheck::look(const Image<std::uint16_t>& steps, const Steps& meaning,
                      const Image<float>& depth_m) {
  check_steps(steps, meaning);
  look(depth_m);
}

void DepthCheck::look(const Image<float>& depth_m) {
  ++looked_;
  check_range(depth_m);
}

}  // namespace mixrig::take
