// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/phase_decoder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::depth {
namespace {

constexpr float kLeastLightSigmas = 2.5;  ///< darker pixels have no usable phase
/// Multipath adds to the phasor of each frequency up to this share of it: phases (in radians) and
/// relative contrasts may differ by as much. It enters the test of the fit's residuals, not the
/// fit's weights.
constexpr float kBounced = 0.08F;

/// Returns atan2(y, x) in turns, -0.5 to 0.5, to 1.7e-6 rad: octants and an odd polynomial of
/// degree 11 (minimax, by weighted least squares).
inline float turns_of(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float low = std::min(ax, ay), high = std::max(ax, ay);
  const float q = low / (high + 1e-20F), q2 = q * q;
  float t = -0.00186514747F;
  t = t * q2 + 0.00837905961F;
  t = t * q2 - 0.01852982696F;
  t = t * q2 + 0.03080289898F;
  t = t * q2 - 0.05293856602F;
  t = (t * q2 + 0.15915131735F) * q;
  t = ay > ax ? 0.25F - t : t;
  t = x < 0 ? 0.5F - t : t;
  return y < 0 ? -t : t;
}

}  // namespace

/// Values of a row between the steps; arrays of frequencies first.
struct PhaseDecoder::PhaseRow {
  std::array<Row, 3> distance_m;  ///< distance modulo the frequency's range
  std::array<Row, 3> light;       ///< amplitude over contrast
  std::array<Row, 3> weight;      ///< one over the variance of the distance
  std::array<Row, 3> judge;       ///< weight with the variance of multipath added
  Row contrast_misfit, noise;
  std::array<std::int16_t, kColumns> most;  ///< largest of the nine samples
};

PhaseCamera kinect2_phase_camera(const device::Kinect2Infrared& infrared,
                                 const device::Kinect2Offsets& offsets) {
  PhaseCamera camera;
  const auto& [k1, k2, p1, p2, k3] = infrared.distortion;
  camera.lens = {
      {device::kKinect2Depth, infrared.fx_px, infrared.fy_px, infrared.cx_px, infrared.cy_px},
      geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})};
  constexpr double kTurns = device::kKinect2OffsetStep_rad / (2 * std::numbers::pi);
  for (std::size_t f = 0; f < 3; ++f) {
    camera.offset_turns[f].reset(device::kKinect2Depth);
    for (int y = 0; y < device::kKinect2Depth.height; ++y)
      for (int x = 0; x < device::kKinect2Depth.width; ++x)
        camera.offset_turns[f].row(y)[x] = static_cast<float>(kTurns * offsets[f].row(y)[x]);
  }
  camera.range_m = {1.875, 9.375, 1.25};
  camera.contrast = {1 / 1.322581, 1, 1 / 1.612903};
  camera.light_x_m = -0.045;
  camera.read_variance = 7;
  camera.variance_per_light = 0.11;
  camera.phase_floor_turns = 0.002;
  camera.longest_m = 9.375;
  return camera;
}

PhaseDecoder::PhaseDecoder(const PhaseCamera& camera)
    : size_(device::kKinect2Depth),
      read_variance_(static_cast<float>(camera.read_variance)),
      variance_per_light_(static_cast<float>(camera.variance_per_light)),
      floor_variance_turns_(
          static_cast<float>(camera.phase_floor_turns * camera.phase_floor_turns)),
      light_m_(static_cast<float>(camera.light_x_m)),
      wraps_(static_cast<int>(std::ceil(camera.longest_m / camera.range_m[0]))),
      bounced_(camera.range_m),
      offset_turns_(camera.offset_turns),
      light_along_m_(size_, 0.0F) {
  for (std::size_t f = 0; f < 3; ++f) {
    range_m_[f] = static_cast<float>(camera.range_m[f]);
    scale_[f] = static_cast<float>(2 / (3 * camera.contrast[f]));
    sigma_scale_[f] = static_cast<float>(1 / camera.contrast[f]);
  }
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x)
      if (const auto ray = camera.lens.unproject({x, y}))
        light_along_m_.row(y)[x] =
            static_cast<float>(camera.light_x_m * ray->x() / std::sqrt(1 + ray->squaredNorm()));
  for (Image<float>* image : {&way_m_, &variance_m2_, &misfit_, &margin_, &light_, &fine_m_,
                              &coarse_m_, &spread_m_, &fine_light_, &first_light_, &surface_})
    image->reset(size_, 0.0F);
  state_.reset(size_);
}

void PhaseDecoder::measure_phases(std::span<const std::uint8_t> pictures, int y,
                                  PhaseRow& row) const {
  std::array<std::array<std::int16_t, kColumns>, 9> samples;
  for (std::size_t k = 0; k < samples.size(); ++k)
    device::unpack_kinect2_row(
        pictures.subspan(k * device::kKinect2PictureBytes, device::kKinect2PictureBytes), y,
        samples[k].data());
  row.most.fill(0);
  for (std::size_t f = 0; f < 3; ++f) {
    const auto &s0 = samples[3 * f], &s1 = samples[3 * f + 1], &s2 = samples[3 * f + 2];
    const float* offset = offset_turns_[f].row(y);
    const float range = range_m_[f], scale = scale_[f];
    for (std::size_t x = 0; x < kColumns; ++x) {
      row.most[x] = std::max(std::max(row.most[x], s0[x]), std::max(s1[x], s2[x]));
      const float a = s0[x] - 0.5F * static_cast<float>(s1[x] + s2[x]);
      const float b = 0.8660254F * static_cast<float>(s2[x] - s1[x]);
      const float turns = turns_of(b, a) + offset[x];
      row.distance_m[f][x] = range * (turns - std::floor(turns));
      row.light[f][x] = scale * std::sqrt(a * a + b * b);
    }
  }
}

/// Combines the light of the three frequencies, each weighted by its variance; then sets the
/// variances of the distances.
void PhaseDecoder::weigh(int y, PhaseRow& row) {
  Row light, variance;  // on the stack, where the compiler sees that nothing else points to them
  std::array<float, 3> share;
  for (std::size_t f = 0; f < 3; ++f) share[f] = 1 / (sigma_scale_[f] * sigma_scale_[f]);
  const std::array<float, 3> range = range_m_;
  const float shares = share[0] + share[1] + share[2];
  const float read = read_variance_, per_light = variance_per_light_, floor = floor_variance_turns_;
  constexpr float kPerTurn2 = 1 / (4 * std::numbers::pi_v<float> * std::numbers::pi_v<float>);
  for (std::size_t x = 0; x < kColumns; ++x) {
    const float mean =
        (share[0] * row.light[0][x] + share[1] * row.light[1][x] + share[2] * row.light[2][x]) /
        shares;
    const float own = (2.0F / 3) * (read + per_light * mean);
    const float bounced = kBounced * mean;
    float sum = 0, deviation = 0;
    for (std::size_t f = 0; f < 3; ++f) {
      const float l = row.light[f][x], v = own / share[f], range2 = range[f] * range[f];
      deviation += (l - mean) * (l - mean) / (v + bounced * bounced);
      const float turns2 = kPerTurn2 * v / (l * l + 0.01F) + floor;
      row.weight[f][x] = 1 / (range2 * turns2);
      row.judge[f][x] = 1 / (range2 * (turns2 + kPerTurn2 * kBounced * kBounced));
      sum += row.weight[f][x];
    }
    light[x] = mean;
    row.noise[x] = std::sqrt(own);
    variance[x] = 1 / sum;
    row.contrast_misfit[x] = deviation;
  }
  std::copy(light.begin(), light.end(), light_.row(y));
  std::copy(variance.begin(), variance.end(), variance_m2_.row(y));
}

/// Finds the least chi^2 over the wraps of the first frequency, and the second least.
void PhaseDecoder::unwrap(int y, PhaseRow& row) {
  Row way, misfit, second, variance, fine, coarse, spread;
  std::copy_n(variance_m2_.row(y), kColumns, variance.begin());
  way.fill(0), misfit.fill(1e30F), second.fill(1e30F);
  fine.fill(0), coarse.fill(0), spread.fill(0);
  const std::array<float, 3> range = range_m_;
  for (int n = 0; n < wraps_; ++n)
    for (std::size_t x = 0; x < kColumns; ++x) {
      const float d0 = row.distance_m[0][x] + range[0] * static_cast<float>(n);
      const float e1 = row.distance_m[1][x] - d0, e2 = row.distance_m[2][x] - d0;
      const float r1 = e1 - range[1] * std::floor(e1 / range[1] + 0.5F);
      const float r2 = e2 - range[2] * std::floor(e2 / range[2] + 0.5F);
      const float shift = (row.weight[1][x] * r1 + row.weight[2][x] * r2) * variance[x];
      const float left = row.judge[0][x] * shift * shift +
                         row.judge[1][x] * (r1 - shift) * (r1 - shift) +
                         row.judge[2][x] * (r2 - shift) * (r2 - shift);
      const bool better = left < misfit[x];
      second[x] = better ? misfit[x] : std::min(second[x], left);
      way[x] = better ? d0 + shift : way[x];
      fine[x] = better ? r2 - shift : fine[x];
      coarse[x] = better ? r1 - r2 : coarse[x];
      spread[x] = better ? -r2 : spread[x];
      misfit[x] = better ? left : misfit[x];
    }
  std::copy(way.begin(), way.end(), way_m_.row(y));
  std::copy(misfit.begin(), misfit.end(), misfit_.row(y));
  std::copy(second.begin(), second.end(), margin_.row(y));
  std::copy(fine.begin(), fine.end(), fine_m_.row(y));
  std::copy(coarse.begin(), coarse.end(), coarse_m_.row(y));
  std::copy(spread.begin(), spread.end(), spread_m_.row(y));
  float *fine_light = fine_light_.row(y), *first_light = first_light_.row(y);
  for (std::size_t x = 0; x < kColumns; ++x) {
    fine_light[x] = row.light[2][x] / (row.light[1][x] + 0.01F);
    first_light[x] = row.light[0][x] / (row.light[1][x] + 0.01F);
  }
}

void PhaseDecoder::decode_row(std::span<const std::uint8_t> pictures, int y) {
  PhaseRow row;
  measure_phases(pictures, y, row);
  weigh(y, row);
  unwrap(y, row);
  const float *way = way_m_.row(y), *light = light_.row(y);
  float *misfit = misfit_.row(y), *margin = margin_.row(y);
  PixelState* state = state_.row(y);
  for (std::size_t x = 0; x < kColumns; ++x) {
    margin[x] -= misfit[x];
    misfit[x] += row.contrast_misfit[x];
    const bool dark = light[x] < kLeastLightSigmas * row.noise[x];
    const bool contradicted = misfit[x] > kMostMisfit || margin[x] < kLeastMargin || way[x] <= 0;
    const PixelState seen = dark           ? PixelState::kDark
                            : contradicted ? PixelState::kMixed
                                           : PixelState::kGood;
    state[x] = row.most[x] == device::kKinect2Saturated ? PixelState::kSaturated : seen;
  }
  // The device leaves out its first and last column.
  state[0] = state[kColumns - 1] = PixelState::kDark;
}

void PhaseDecoder::decode(std::span<const std::uint8_t> pictures, PhaseDepth& out) {
  for (Image<float>* image : {&out.distance_m, &out.sigma_m, &out.amplitude, &out.confidence})
    if (image->size() != size_) image->reset(size_);
  if (out.state.size() != size_) out.state.reset(size_);
  for (int y = 0; y < size_.height; ++y) decode_row(pictures, y);
  for (int y = 0; y < size_.height; ++y) judge_row(y, out);
  if (bounced_on_) correct_bounced(out);
}

}  // namespace mixrig::depth
