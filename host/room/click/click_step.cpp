// SPDX-License-Identifier: Apache-2.0
#include "host/room/click/click_step.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::model {
namespace {

using Eigen::Vector2d;

constexpr int kStepDirections = 16;  ///< of lines, over 180 degrees
constexpr std::size_t kMostPlaces = 4096;
constexpr int kLeastStepSide = 12;     ///< places
constexpr std::size_t kNearest = 21;   ///< places that tell how far off the click is
constexpr std::size_t kMostSteps = 4;  ///< sides of a rectangle
constexpr double kStepSigmas = 6;      ///< of the difference of both means
constexpr double kLeastStep = 0.4;     ///< sigmas of one depth

double mean_near(std::vector<PlaceOff> places, const Vector2d& click_px) {
  const std::size_t count = std::min(kNearest, places.size());
  std::partial_sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(count),
                    places.end(), [&](const PlaceOff& a, const PlaceOff& b) {
                      return (a.px - click_px).squaredNorm() < (b.px - click_px).squaredNorm();
                    });
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += places[i].sigmas;
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

/// The best line across one direction; sorts the places along it.
StepLine best_across(const Vector2d& normal, std::vector<PlaceOff>& places,
                     const Vector2d& click_px, double click_sigmas) {
  std::sort(places.begin(), places.end(), [&](const PlaceOff& a, const PlaceOff& b) {
    return normal.dot(a.px) < normal.dot(b.px);
  });
  double all = 0, sum = 0;
  for (const PlaceOff& place : places) all += place.sigmas;
  const auto count = static_cast<double>(places.size());
  StepLine best;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    sum += places[i].sigmas;
    const double low = static_cast<double>(i) + 1, high = count - low;
    const double here_px = normal.dot(places[i].px), next_px = normal.dot(places[i + 1].px);
    if (std::min(low, high) < kLeastStepSide || next_px - here_px < 1e-6) continue;
    const double at_px = 0.5 * (here_px + next_px);
    const bool is_low = normal.dot(click_px) < at_px;
    const double below = sum / low, above = (all - sum) / high;
    const double here = is_low ? below : above, there = is_low ? above : below;
    if (std::abs(here - there) < kLeastStep ||
        std::abs(click_sigmas - here) > std::abs(click_sigmas - there))
      continue;
    const double contrast = std::abs(here - there) * std::sqrt(low * high / count);
    if (contrast > best.contrast)
      best = {is_low ? normal : Vector2d(-normal), is_low ? at_px : -at_px, contrast};
  }
  return best;
}

}  // namespace

std::vector<StepLine> find_steps(std::span<const PlaceOff> places, const Vector2d& click_px) {
  std::vector<PlaceOff> kept;
  const std::size_t stride = places.size() / kMostPlaces + 1;
  for (std::size_t i = 0; i < places.size(); i += stride) kept.push_back(places[i]);
  const double click_sigmas = mean_near(kept, click_px);
  std::vector<StepLine> steps;
  while (steps.size() < kMostSteps) {
    StepLine best;
    for (int i = 0; i < kStepDirections; ++i) {
      const double turn_rad = std::numbers::pi * i / kStepDirections;
      const StepLine line =
          best_across({std::cos(turn_rad), std::sin(turn_rad)}, kept, click_px, click_sigmas);
      if (line.contrast > best.contrast) best = line;
    }
    if (best.contrast < kStepSigmas) break;
    steps.push_back(best);
    std::erase_if(kept, [&](const PlaceOff& place) { return best.is_beyond(place.px); });
  }
  return steps;
}

}  // namespace mixrig::model
