// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/grey_card.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace mixrig::capture {
namespace {

using device::Transfer;

constexpr std::size_t kFirstSaturated = 250;
constexpr double kMostSaturated = 0.01, kLeastByte = 24, kMostSpread = 0.3, kMostUnsure = 5e-3;
constexpr double kGreyWithin = 0.03, kLinearWithin = 0.03, kSteadyWithin = 0.02, kLeastEffect = 1.1;
constexpr double kBlackStep = 0.25 / 255, kMostBlack = 0.25;
constexpr double kLeastGamma = 0.5, kMostGamma = 4, kGammaStep = 0.01;

using Counts = std::array<std::uint32_t, 256>;
using Lights = std::array<double, 256>;

double total(const Counts& counts) {
  double sum = 0;
  for (const std::uint32_t n : counts) sum += n;
  return sum;
}

double mean_of(const Counts& counts, const Lights& lights) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) sum += counts[i] * lights[i];
  return sum / total(counts);
}

double sample_of(bool cut, std::size_t byte) {
  const auto value = static_cast<double>(byte);
  return cut ? (value + 0.5) / 256 : value / 255;
}

/// Returns the linear light of each byte.
Lights lights_of(bool cut, const ColorSettings& settings) {
  Lights lights{};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const double above = (sample_of(cut, i) - settings.black) / (1 - settings.black);
    lights[i] = linear_light(settings.encoding, std::clamp(above, 0.0, 1.0));
  }
  return lights;
}

/// Returns the largest log of light over exposure from each exposure to the next.
double deviation(std::span<const CardSamples> exposures, const ColorSettings& settings) {
  const Lights lights = lights_of(exposures[0].cut, settings);
  double worst = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i + 1 < exposures.size(); ++i) {
      const double a = mean_of(exposures[i].counts[c], lights),
                   b = mean_of(exposures[i + 1].counts[c], lights);
      if (!(a > 0 && b > 0)) return std::numeric_limits<double>::infinity();
      const double off =
          std::log(a / b) - std::log(exposures[i].exposure_s / exposures[i + 1].exposure_s);
      worst = std::max(worst, std::abs(off));
    }
  return worst;
}

/// The best candidate so far.
struct Nearest {
  std::span<const CardSamples> exposures;
  ColorSettings settings;
  double error = std::numeric_limits<double>::infinity();

  void offer(const ColorSettings& candidate) {
    const double off = deviation(exposures, candidate);
    if (off < error) error = off, settings = candidate;
  }
  bool fits() const { return error < kLinearWithin; }
};

constexpr std::array kNamed{Transfer::kSrgb, Transfer::kBt709, Transfer::kLinear};

void offer_named(Nearest& nearest, ColorSettings candidate) {
  for (const Transfer transfer : kNamed) {
    candidate.encoding.transfer = transfer;
    nearest.offer(candidate);
  }
}

void offer_blacks(Nearest& nearest, ColorSettings candidate) {
  for (double black = 0; black <= kMostBlack; black += kBlackStep) {
    candidate.black = black;
    offer_named(nearest, candidate);
    if (candidate.encoding.transfer == Transfer::kGamma) nearest.offer(candidate);
  }
}

void offer_gammas(Nearest& nearest, ColorSettings candidate) {
  candidate.encoding.transfer = Transfer::kGamma;
  for (double gamma = kLeastGamma; gamma <= kMostGamma; gamma += kGammaStep) {
    candidate.encoding.gamma = gamma;
    nearest.offer(candidate);
  }
}

std::array<double, 2> doublings_of(std::span<const CardSamples, 4> exposures,
                                   const ColorSettings& settings) {
  std::array<double, 2> factors{};
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double a = mean_light(exposures[i], settings)[1],
                 b = mean_light(exposures[i + 1], settings)[1];
    const double stops = std::log2(exposures[i].exposure_s / exposures[i + 1].exposure_s);
    factors[i] = b > 0 ? std::exp2(std::log2(a / b) / stops) : 0;
  }
  return factors;
}

}  // namespace

void CardSamples::add(ImageView<const Rgb8> plate, const CardArea& area) {
  assert(area.x >= 0 && area.y >= 0 && area.x + area.size.width <= plate.size.width &&
         area.y + area.size.height <= plate.size.height);
  for (int y = area.y; y < area.y + area.size.height; ++y)
    for (int x = area.x; x < area.x + area.size.width; ++x) {
      const Rgb8 pixel = plate.row(y)[x];
      ++counts[0][pixel.r], ++counts[1][pixel.g], ++counts[2][pixel.b];
    }
}

double CardSamples::mean_byte(std::size_t color) const {
  double sum = 0;
  for (std::size_t i = 0; i < 256; ++i) sum += counts[color][i] * static_cast<double>(i);
  return sum / total(counts[color]);
}

double CardSamples::saturated_share() const {
  double most = 0;
  for (const Counts& channel : counts) {
    double sum = 0;
    for (std::size_t i = kFirstSaturated; i < 256; ++i) sum += channel[i];
    most = std::max(most, sum / total(channel));
  }
  return most;
}

ColorSettings raw_settings(const ColorSettings& settings) {
  ColorSettings raw = settings;
  raw.encoding.transfer = Transfer::kSrgb;
  raw.black = 0;
  raw.gains = {1, 1, 1};
  return raw;
}

std::array<double, 3> mean_light(const CardSamples& samples, const ColorSettings& settings) {
  const Lights lights = lights_of(samples.cut, settings);
  return {mean_of(samples.counts[0], lights), mean_of(samples.counts[1], lights),
          mean_of(samples.counts[2], lights)};
}

CardState card_state(const CardSamples& samples, const ColorSettings& settings) {
  if (samples.saturated_share() > kMostSaturated) return CardState::kSaturated;
  const Lights lights = lights_of(samples.cut, settings);
  Lights squares = lights;
  for (double& light : squares) light *= light;
  double spread = 0, unsure = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (samples.mean_byte(c) - 255 * settings.black < kLeastByte) return CardState::kDark;
    const double mean = mean_of(samples.counts[c], lights);
    const double variance = mean_of(samples.counts[c], squares) - mean * mean;
    spread = std::max(spread, std::sqrt(std::max(variance, 0.0)) / mean);
    unsure = std::max(unsure, spread / std::sqrt(total(samples.counts[c])));
  }
  if (spread > kMostSpread) return CardState::kUneven;
  return unsure > kMostUnsure ? CardState::kTooNoisy : CardState::kGood;
}

GreyVerdict judge_grey(const CardSamples& samples, const ColorSettings& settings) {
  const std::array<double, 3> light = mean_light(samples, settings);
  const double most = std::max({light[0], light[1], light[2]});
  GreyVerdict verdict;
  for (std::size_t c = 0; c < 3; ++c) verdict.gains[c] = most / light[c];
  const double green = light[1] * settings.gains[1];
  verdict.red_green = light[0] * settings.gains[0] / green;
  verdict.blue_green = light[2] * settings.gains[2] / green;
  verdict.grey = std::abs(verdict.red_green - 1) < kGreyWithin &&
                 std::abs(verdict.blue_green - 1) < kGreyWithin;
  return verdict;
}

LinearVerdict judge_linear(std::span<const CardSamples, 4> exposures,
                           const ColorSettings& settings) {
  using Kind = LinearVerdict::Kind;
  LinearVerdict verdict{Kind::kRight, doublings_of(exposures, settings), settings, 0};
  const double first = mean_light(exposures[0], settings)[1];
  if (exposures[0].mean_byte(1) < kLeastEffect * exposures[2].mean_byte(1))
    return verdict.kind = Kind::kNoEffect, verdict;
  if (std::abs(mean_light(exposures[3], settings)[1] / first - 1) > kSteadyWithin)
    return verdict.kind = Kind::kUnsteady, verdict;
  const auto falling = exposures.first<3>();
  verdict.error = deviation(falling, settings);
  if (verdict.error < kLinearWithin) return verdict;
  Nearest nearest{falling, settings};
  offer_named(nearest, settings);
  if (!nearest.fits()) {
    offer_blacks(nearest, settings);
    offer_gammas(nearest, settings);
  }
  verdict.kind = nearest.fits() ? Kind::kOther : Kind::kNoneFits;
  verdict.error = nearest.error;
  if (nearest.fits()) verdict.fit = nearest.settings;
  return verdict;
}

}  // namespace mixrig::capture
