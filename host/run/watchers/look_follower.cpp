// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/look_follower.h"

#include <algorithm>
#include <cmath>

namespace mixrig::session {
namespace {

using render::PictureLook;

// Differences from plate to plate of a camera that does not change are less.
constexpr float kBlurStep_px = 0.06F, kChromaStep_px = 0.15F, kSharpeningStep = 0.05F;
constexpr float kNoiseStep = 0.1F;          ///< of the noise's sigma
constexpr float kNear = 0.02F;              ///< of the way that is left, where it ends
constexpr float kDim = 0.05F, kLit = 0.4F;  ///< light at which noise is compared
constexpr double kLongest_s = 0.25;         ///< between frames that follow each other

float middle_of(float a, float b, float c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}
glm::vec3 middle_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return glm::max(glm::min(a, b), glm::min(glm::max(a, b), c));
}

PictureLook middle_of(const PictureLook& a, const PictureLook& b, const PictureLook& c) {
  PictureLook m = a;  // with its spread and correlation of noise
  m.grain.floor = middle_of(a.grain.floor, b.grain.floor, c.grain.floor);
  m.grain.slope = middle_of(a.grain.slope, b.grain.slope, c.grain.slope);
  m.blur_px = middle_of(a.blur_px, b.blur_px, c.blur_px);
  m.sharpening = middle_of(a.sharpening, b.sharpening, c.sharpening);
  for (int i = 0; i < 2; ++i)
    m.chroma_px[i] = middle_of(a.chroma_px[i], b.chroma_px[i], c.chroma_px[i]);
  return m;
}

bool noise_differs(const render::Grain& a, const render::Grain& b) {
  for (const float light : {kDim, kLit})
    for (int c = 0; c < 3; ++c) {
      const float one = std::sqrt(a.floor[c] + light * a.slope[c]);
      const float other = std::sqrt(b.floor[c] + light * b.slope[c]);
      if (std::abs(one - other) > kNoiseStep * std::max(one, other)) return true;
    }
  return false;
}

bool differ(const PictureLook& a, const PictureLook& b) {
  const glm::vec2 chroma = glm::abs(a.chroma_px - b.chroma_px);
  return std::abs(a.blur_px - b.blur_px) > kBlurStep_px ||
         std::abs(a.sharpening - b.sharpening) > kSharpeningStep ||
         std::max(chroma.x, chroma.y) > kChromaStep_px || noise_differs(a.grain, b.grain);
}

PictureLook between(const PictureLook& a, const PictureLook& b, float share) {
  PictureLook m = b;
  m.grain.floor = glm::mix(a.grain.floor, b.grain.floor, share);
  m.grain.slope = glm::mix(a.grain.slope, b.grain.slope, share);
  m.blur_px = glm::mix(a.blur_px, b.blur_px, share);
  m.sharpening = glm::mix(a.sharpening, b.sharpening, share);
  m.chroma_px = glm::mix(a.chroma_px, b.chroma_px, share);
  return m;
}

}  // namespace

void LookFollower::add(const PictureLook& measured) {
  last_[static_cast<std::size_t>(count_ % 3)] = measured;
  if (count_ == 0) {
    last_.fill(measured);
    aim_ = now_ = measured;
  }
  ++count_;
  const PictureLook middle = middle_of(last_[0], last_[1], last_[2]);
  if (!differ(middle, aim_)) return;
  go_to(middle);
}

void LookFollower::take_motion_out(const glm::vec2& way_px) {
  // A point that moves evenly over a way of 1 has a variance of 1/12 along it.
  PictureLook still = aim_;
  const float blur_px2 = still.blur_px * still.blur_px - glm::dot(way_px, way_px) / 24;
  still.blur_px = std::sqrt(std::max(0.0F, blur_px2));
  last_.fill(still);
  go_to(still);
}

void LookFollower::go_to(const PictureLook& aim) { aim_ = aim, from_ = now_, left_ = 1; }

const PictureLook& LookFollower::at(double time_s) {
  const double step_s = last_s_ ? time_s - *last_s_ : 0;
  last_s_ = time_s;
  if (left_ == 0) return now_;
  left_ *= static_cast<float>(std::exp(-std::clamp(step_s, 0.0, kLongest_s) / kSettle_s));
  if (left_ < kNear) left_ = 0;
  now_ = between(aim_, from_, left_);
  return now_;
}

}  // namespace mixrig::session
