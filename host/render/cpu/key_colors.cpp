// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key_colors.h"

#include <cmath>

namespace mixrig::render::cpu {
namespace {

/// Least spread of a colour: noise and flicker of light.
float floor_sigma(const glm::vec3& c) { return kColorNoise + kColorFlicker * luminance(c); }

NearColor mean_of(const ColorSums& sums) {
  NearColor out;
  if (sums.count < kBlockPx) return out;
  const float n = static_cast<float>(sums.count);
  out.known = true;
  out.mean = sums.color / n;
  const glm::vec3 variance = sums.square / n - out.mean * out.mean;
  const float floor = floor_sigma(out.mean);
  out.variance = std::max(0.0F, (variance.r + variance.g + variance.b) / 3) + floor * floor;
  return out;
}

float square(const glm::vec3& v) { return glm::dot(v, v); }

/// Squared distance to the background over its variance.
struct Distance {
  float square, variance;
  bool is_brighter;  ///< than a learned background
};

Distance to_learned(const KeyInput& input, const glm::vec3& p, const Rgbf& learned, int x, int y) {
  const glm::vec3 b = glm::min(input.gain * glm::vec3(learned.r, learned.g, learned.b), 1.0F);
  const float floor = floor_sigma(b);
  const float spread = input.background.color_sigma.empty()
                           ? 0
                           : input.gain.g * input.background.color_sigma.row(y)[x];
  const float variance = spread * spread + floor * floor;
  const float k =
      std::clamp(glm::dot(p, b) / std::max(glm::dot(b, b), 1e-8F), kDarkestShadow, 1.0F);
  const float dark = (1 - k) / kShadowSigma;
  return {square(p - k * b) / variance + dark * dark, variance,
          luminance(p) > kBrighter * luminance(b) + kBrighterLight};
}

}  // namespace

NearColors colors_around(const KeyScratch& scratch, int bx, int by, int radius) {
  NearColors out;
  int foreground = 0;
  ColorSums people, room;
  around(scratch, bx, by, radius, [&](const Block& b) {
    foreground += b.foreground;
    out.w += b.w_sum;
    people.add(b.people);
    room.add(b.room);
  });
  if (foreground > 0) out.w /= static_cast<float>(foreground);
  out.people = mean_of(people);
  out.room = mean_of(room);
  return out;
}

float color_vote(const KeyInput& input, const NearColors& near, int x, int y) {
  const glm::vec3 p = linear(input.plate.row(y)[x]);
  Distance room{};
  if (input.learned()) {
    const Rgbf learned = input.background.color.row(y)[x];
    if (learned.r < 0) return 0;  // unknown
    room = to_learned(input, p, learned, x, y);
    if (!near.people.known)
      return std::clamp(0.5F * room.square - kColorVoteCap, -kColorVoteCap, kColorVoteCap);
  } else {
    if (!near.people.known || !near.room.known) return 0;
    room = {square(p - near.room.mean) / near.room.variance, near.room.variance, false};
  }
  const NearColor& people = near.people;
  const float cap = input.learned() ? kColorVoteCap : kRoomVoteCap;
  return std::clamp(0.5F * (room.square - square(p - people.mean) / people.variance) +
                        kSpreadOdds * std::log(room.variance / people.variance),
                    -cap, room.is_brighter ? kBrighterVoteCap : cap);
}

}  // namespace mixrig::render::cpu
