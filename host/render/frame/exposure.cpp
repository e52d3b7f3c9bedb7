// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/exposure.h"

#include <algorithm>
#include <cmath>

#include "hal/base/srgb.h"

namespace mixrig::render {
namespace {

constexpr int kGridX = 64, kGridY = 48;
constexpr float kDarkest = 0.01F, kBrightest = 0.9F;  // linear; beyond, noise or saturation
constexpr std::size_t kLeastSamples = 60;
constexpr float kMostGain = 8;
// Tone curve: smaller deviations (natural logarithm) are noise; a knot needs kLeastAround places.
constexpr float kStraight = 0.04F;
constexpr std::size_t kLeastAround = 40;

bool is_usable(const glm::vec3& c) {
  return glm::all(glm::greaterThan(c, glm::vec3(kDarkest))) &&
         glm::all(glm::lessThan(c, glm::vec3(kBrightest)));
}

glm::vec3 linear_of(Rgb8 c) {
  const auto& linear = linear_of_srgb_bytes();
  return {linear[c.r], linear[c.g], linear[c.b]};
}

/// Sets the nearest plate pixel of a place; negative if it lies outside.
void put(const glm::vec2& at, Size plate, ExposureMeter::Place& place) {
  place.plate_x = place.plate_y = -1;
  if (!(at.x >= 0 && at.y >= 0)) return;
  const int x = static_cast<int>(at.x + 0.5F), y = static_cast<int>(at.y + 0.5F);
  if (x < plate.width && y < plate.height) place.plate_x = x, place.plate_y = y;
}

}  // namespace

ExposureMeter::ExposureMeter(const Tables& tables, const BackgroundView& background) {
  const Size view = tables.view_size, plate = tables.plate_size;
  for (int j = 0; j < kGridY; ++j)
    for (int i = 0; i < kGridX; ++i) {
      const int x = (2 * i + 1) * view.width / (2 * kGridX);
      const int y = (2 * j + 1) * view.height / (2 * kGridY);
      const glm::vec2 at = tables.plate_is_view ? glm::vec2(x, y) : tables.plate_px.row(y)[x];
      const float gain = tables.plate_gain.empty() ? 1 : tables.plate_gain.row(y)[x];
      Place place{x, y, -1, -1, gain};
      put(at, plate, place);
      // If the lens moves, a place outside the plate may come into it later.
      if (place.plate_x >= 0 || tables.lens_moves) grid_.push_back(place);
    }
  samples_.reserve(grid_.size());
  seen_.reserve(grid_.size());
  ratios_.reserve(grid_.size());
  order_.reserve(grid_.size());
  learn(background);
}

void ExposureMeter::see_through(const CompositorSetup& setup) {
  for (Place& place : grid_) {
    const Eigen::Vector2d ray = setup.view.unproject(Eigen::Vector2d(place.view_x, place.view_y));
    const auto px = setup.target.project({ray.x(), ray.y(), 1.0});
    put(px ? glm::vec2(px->x(), px->y()) : glm::vec2(-1), setup.target.size_px(), place);
  }
}

void ExposureMeter::learn(const BackgroundView& background) {
  samples_.clear();
  if (background.color.empty()) return;
  for (const Place& place : grid_) {
    const Rgbf b = background.color.row(place.view_y)[place.view_x];
    const glm::vec3 learned(b.r, b.g, b.b);
    if (place.plate_x >= 0 && is_usable(learned))
      samples_.push_back({place.plate_x, place.plate_y, place.gain, learned});
  }
}

void ExposureMeter::learn(std::span<const glm::vec4> colors) {
  samples_.clear();
  for (std::size_t i = 0; i < std::min(colors.size(), grid_.size()); ++i)
    if (grid_[i].plate_x >= 0 && is_usable(glm::vec3(colors[i])))
      samples_.push_back({grid_[i].plate_x, grid_[i].plate_y, grid_[i].gain, glm::vec3(colors[i])});
}

glm::vec3 ExposureMeter::gain(ImageView<const Rgb8> plate) {
  seen_.clear();
  for (const Sample& s : samples_) seen_.push_back(linear_of(plate.row(s.y)[s.x]));
  return gain_of_seen();
}

glm::vec3 ExposureMeter::gain_of_seen() {
  ratios_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& s = samples_[i];
    const glm::vec3 seen = seen_[i], now = s.gain * seen;
    if (is_usable(seen))
      ratios_.push_back({std::log(luminance(now) / luminance(s.learned)), now, s.learned});
  }
  if (ratios_.size() < kLeastSamples) return glm::vec3(1);
  const Ratio most = densest_third();
  return glm::clamp(most.plate / most.learned, 1 / kMostGain, kMostGain);
}

ExposureMeter::Ratio ExposureMeter::densest_third() {
  order_.clear();
  for (std::uint32_t i = 0; i < ratios_.size(); ++i)
    order_.push_back({ratios_[i].log_luminance, i});
  std::sort(order_.begin(), order_.end());
  const std::size_t third = order_.size() / 3;
  std::size_t best = 0;
  const auto width = [&](std::size_t i) { return order_[i + third].first - order_[i].first; };
  for (std::size_t i = 1; i + third < order_.size(); ++i)
    if (width(i) < width(best)) best = i;
  Ratio sum;
  for (std::size_t i = best; i <= best + third; ++i) {
    sum.plate += ratios_[order_[i].second].plate;
    sum.learned += ratios_[order_[i].second].learned;
  }
  return sum;
}

std::optional<glm::vec3> ExposureMeter::around_knot(float knot, const glm::vec3& gain) {
  constexpr float kHalfOctave = 1.4142136F;
  ratios_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& s = samples_[i];
    const float light = luminance(s.learned);
    const bool is_first = knot == kToneFirstKnot;
    if (light > knot * kHalfOctave || (light <= knot / kHalfOctave && !is_first)) continue;
    const glm::vec3 seen = seen_[i];
    if (glm::any(glm::lessThan(seen, glm::vec3(kDarkest)))) continue;
    // White clips: the curve ends there too.
    const glm::vec3 now = glm::min(s.gain * seen, 1.0F);
    ratios_.push_back({std::log(luminance(now) / light), now, s.learned});
  }
  if (ratios_.size() < kLeastAround) return std::nullopt;
  const Ratio most = densest_third();
  glm::vec3 ratio = glm::clamp(most.plate / (most.learned * gain), 1 / kMostGain, kMostGain);
  // Tones cannot differ by more than the exposure has changed.
  const float changed = std::abs(std::log(luminance(gain)));
  for (int c = 0; c < 3; ++c) {
    const float off = std::clamp(std::log(ratio[c]), -changed, changed);
    ratio[c] = std::exp(off - std::clamp(off, -kStraight, kStraight));
  }
  return ratio;
}

ToneCurve ExposureMeter::curve(ImageView<const Rgb8> plate) {
  seen_.clear();
  for (const Sample& s : samples_) seen_.push_back(linear_of(plate.row(s.y)[s.x]));
  return curve_of_seen();
}

ToneCurve ExposureMeter::curve(const RawPicture& plate) {
  seen_.clear();
  for (const Sample& s : samples_) seen_.push_back(linear_of(pixel_of(plate, s.x, s.y)));
  return curve_of_seen();
}

ToneCurve ExposureMeter::curve_of_seen() {
  ToneCurve curve(gain_of_seen());
  // Tones bend at most by what the exposure has changed beyond kStraight (around_knot).
  if (std::abs(std::log(luminance(curve.gain))) <= kStraight) return curve;
  std::array<std::optional<glm::vec3>, kTonePieces> ratio;
  float knot = kToneFirstKnot;
  for (auto& known : ratio) known = around_knot(knot, curve.gain), knot *= 2;
  for (std::size_t i = 1; i < ratio.size(); ++i)
    if (!ratio[i]) ratio[i] = ratio[i - 1];
  for (std::size_t i = ratio.size() - 1; i-- > 0;)
    if (!ratio[i]) ratio[i] = ratio[i + 1];
  const auto is_straight = [](const auto& r) { return !r || *r == glm::vec3(1); };
  if (std::all_of(ratio.begin(), ratio.end(), is_straight)) return curve;
  curve.bends = true;
  glm::vec3 before(0);
  float width = kToneFirstKnot;
  knot = kToneFirstKnot;
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    const glm::vec3 value = glm::max(knot * *ratio[i] * curve.gain, before);
    curve.slope[i] = (value - before) / width;
    before = value, width = knot, knot *= 2;
  }
  return curve;
}

}  // namespace mixrig::render
