// SPDX-License-Identifier: Apache-2.0
// Steps 4 and 5 of PhaseDecoder: comparison with the neighbours of a pixel, and correction of
// multipath.
#include <algorithm>
#include <cmath>

#include "host/capture/depth/phase_decoder.h"

namespace mixrig::depth {
namespace {

constexpr float kAmplitudePerLight = 4;  ///< counts up to 16320 become 16 bits
constexpr float kAgreeSigmas = 3, kAgreeShare = 0.006F;
/// Number of the 8 neighbours that must agree: a pixel on the straight edge of a surface has five
/// good ones. If kMostNeighbours agree, even with a bad fit, they see one surface by multipath; the
/// misfit may then be kMostBounced times as large.
constexpr float kLeastNeighbours = 4, kMostNeighbours = 6, kMostBounced = 4;

/// Constants of step 5: pixels to each side of the window; surface pixels that a mean needs; the
/// misfit at which half of the correction is applied, and the smallest one that is corrected; the
/// largest differences that a tail of light may leave unexplained.
constexpr int kReach = 3;
constexpr float kLeastOfSurface = 8, kHalfMisfit = 8, kLeastMisfit = 1;
constexpr float kMostSpread_m = 0.16F, kMostFirstLight = 0.32F;
constexpr float kMostExplained = 8;  ///< limit of the misfit, over kMostMisfit
constexpr float kShareOfCorrection = 0.33F;

}  // namespace

/// Judges the pixels of a row by their neighbours, and computes the distance from the centre of
/// projection.
void PhaseDecoder::judge_row(int y, PhaseDepth& out) {
  Row sum, weights, agree, beside;
  const float *way = way_m_.row(y), *variance = variance_m2_.row(y);
  const PixelState* own = state_.row(y);
  for (std::size_t x = 0; x < kColumns; ++x) {
    weights[x] = 1 / variance[x];
    sum[x] = 0;  // of differences to the pixel's own value, which loses few digits
    agree[x] = beside[x] = 0;
  }
  for (int v = std::max(0, y - 1); v <= std::min(size_.height - 1, y + 1); ++v)
    for (int u = -1; u <= 1; ++u) {
      if (u == 0 && v == y) continue;
      const float *near = way_m_.row(v), *near_variance = variance_m2_.row(v);
      const PixelState* near_state = state_.row(v);
      for (int x = 1; x < kColumns - 1; ++x) {
        const float difference = near[x + u] - way[x];
        const float tolerance =
            kAgreeSigmas * std::sqrt(variance[x] + near_variance[x + u]) + kAgreeShare * way[x];
        const bool within = std::abs(difference) < tolerance;
        const bool agrees = near_state[x + u] == PixelState::kGood && within;
        const float w = agrees ? 1 / near_variance[x + u] : 0.0F;
        sum[x] += w * difference;
        weights[x] += w;
        agree[x] += agrees ? 1.0F : 0.0F;
        beside[x] += within ? 1.0F : 0.0F;
      }
    }
  float *distance = out.distance_m.row(y), *sigma = out.sigma_m.row(y),
        *amplitude = out.amplitude.row(y), *confidence = out.confidence.row(y);
  PixelState* state = out.state.row(y);
  const float *light = light_.row(y), *along = light_along_m_.row(y), *misfit = misfit_.row(y),
              *margin = margin_.row(y);
  float* part = surface_.row(y);
  for (std::size_t x = 0; x < kColumns; ++x) {
    const bool beside_it = beside[x] >= kMostNeighbours && margin[x] > kLeastMargin;
    const bool surface = beside_it && misfit[x] < kMostBounced * kMostMisfit;
    const PixelState good_if =
        surface || (own[x] == PixelState::kGood && agree[x] >= kLeastNeighbours)
            ? PixelState::kGood
            : PixelState::kMixed;
    const bool decided = own[x] == PixelState::kGood || own[x] == PixelState::kMixed;
    const PixelState is = decided ? good_if : own[x];
    part[x] = decided && beside_it ? 1.0F : 0.0F;
    const bool measured = is == PixelState::kGood || is == PixelState::kMixed;
    const float mean = way[x] + (smoothing_ ? sum[x] / weights[x] : 0);
    const float path = 2 * mean;  // from the light to the surface and back
    const float r = (path * path - light_m_ * light_m_) / (2 * (path - along[x]));
    distance[x] = measured && r > 0 ? r : 0.0F;
    sigma[x] = measured ? std::sqrt(smoothing_ ? 1 / weights[x] : variance[x]) : 0.0F;
    amplitude[x] = std::min(65535.0F, kAmplitudePerLight * light[x]);
    // Above 0.5 by the distance to the nearest limit, below by the excess over the worst.
    const float worst =
        std::max(misfit[x] / (kMostBounced * kMostMisfit), kLeastMargin / (margin[x] + 1e-6F));
    const float good = 1 - 0.5F * std::min(worst, 1.0F), bad = 0.49F / std::max(worst, 1.0F);
    confidence[x] = is == PixelState::kGood ? good : is == PixelState::kMixed ? bad : 0.0F;
    state[x] = is;
  }
}

/// Means over the pixels of surfaces in a window around each pixel of a row.
struct PhaseDecoder::SurfaceMeans {
  Row count, fine_m, coarse_m, spread_m, fine_light, first_light;
};

/// Step 5: corrects multipath.
void PhaseDecoder::correct_bounced(PhaseDepth& out) const {
  constexpr std::size_t kSums = 6;
  const std::array<const Image<float>*, kSums> images{&surface_,  &fine_m_,     &coarse_m_,
                                                      &spread_m_, &fine_light_, &first_light_};
  std::array<std::array<float, kColumns + 2 * kReach>, kSums> down{};  // sums of columns
  const auto add = [&](int y, float sign) {
    if (y < 0 || y >= size_.height) return;
    const float* part = surface_.row(y);
    for (std::size_t k = 0; k < kSums; ++k) {
      const float* value = images[k]->row(y);
      for (std::size_t x = 0; x < kColumns; ++x) down[k][x + kReach] += sign * part[x] * value[x];
    }
  };
  for (int y = 0; y < kReach; ++y) add(y, 1);
  for (int y = 0; y < size_.height; ++y) {
    add(y + kReach, 1), add(y - kReach - 1, -1);
    SurfaceMeans means;
    const std::array<Row*, kSums> rows{&means.count,    &means.fine_m,     &means.coarse_m,
                                       &means.spread_m, &means.fine_light, &means.first_light};
    for (std::size_t k = 0; k < kSums; ++k) {
      Row sum{};
      for (std::size_t u = 0; u <= 2 * kReach; ++u)
        for (std::size_t x = 0; x < kColumns; ++x) sum[x] += down[k][x + u];
      for (std::size_t x = 0; x < kColumns; ++x)
        (*rows[k])[x] = k == 0 ? sum[x] : sum[x] / std::max(means.count[x], 1.0F);
    }
    correct_row(y, means, out);
  }
}

void PhaseDecoder::correct_row(int y, const SurfaceMeans& means, PhaseDepth& out) const {
  const float *part = surface_.row(y), *misfit = misfit_.row(y);
  float *distance = out.distance_m.row(y), *sigma = out.sigma_m.row(y);
  for (std::size_t x = 0; x < kColumns; ++x) {
    if (part[x] == 0 || means.count[x] < kLeastOfSurface || misfit[x] < kLeastMisfit) continue;
    const float coarse = means.coarse_m[x], light = means.fine_light[x];
    const BouncedLight::Effect effect = bounced_.at(coarse, light);
    const float change = misfit[x] / (misfit[x] + kHalfMisfit) * (means.fine_m[x] - effect.fine_m);
    if (distance[x] + change > 0) distance[x] += change;
    const float unsure = kShareOfCorrection * change;
    sigma[x] = std::sqrt(sigma[x] * sigma[x] + unsure * unsure);
    if (out.state.row(y)[x] != PixelState::kMixed || misfit[x] > kMostExplained * kMostMisfit ||
        !BouncedLight::covers(coarse, light))
      continue;
    const float spread = (means.spread_m[x] - effect.spread_m) / kMostSpread_m;
    const float first = (means.first_light[x] - effect.first_light) / kMostFirstLight;
    if (spread * spread + first * first > 1) continue;
    out.state.row(y)[x] = PixelState::kGood;
    out.confidence.row(y)[x] = kLeastConfidence;
  }
}

}  // namespace mixrig::depth
