// SPDX-License-Identifier: Apache-2.0
#include "studio/sensors/zoom_lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

constexpr double kBreathing = 0.03;  ///< of the focal length, from near to far
constexpr double kFirstCount = 4000, kZoomCounts = 52000, kFirstFocus = 10000, kFocusCounts = 40000;
constexpr double kCountSigma = 3;  ///< noise of an encoder, before it is rounded
constexpr double kLensRate_hz = 50;
constexpr double kLensPhase_s = 0.0071;  ///< no sample is taken at mid-exposure of a frame
constexpr std::uint64_t kLensNoise = 0x2003;

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

Optics ZoomLens::optics(const LensSetting& at) const {
  const double breathing = 1 + kBreathing * (at.focus - 0.5) * (0.5 + 0.5 * at.zoom);
  const double longer = std::pow(ratio, at.zoom) * breathing;
  Optics o = rest;
  o.fx_px *= longer, o.fy_px *= longer;
  o.cx_px += 0.0025 * rest.size_px.width * at.zoom;
  o.cy_px -= 0.0018 * rest.size_px.width * at.zoom * at.zoom;
  // At the same place of the picture the ray is shorter by `longer`.
  o.distortion[0] *= longer * longer * (1 - 1.4 * at.zoom);
  o.distortion[1] *= std::pow(longer, 4) * (1 - at.zoom);
  o.distortion[2] *= longer, o.distortion[3] *= longer;
  for (double& p : o.prism) p *= std::pow(longer, 3);
  return o;
}

double ZoomLens::pupil_shift_m(const LensSetting& at) const {
  return 0.012 * at.zoom + 0.006 * at.zoom * at.zoom + 0.002 * (at.focus - 0.5);
}

LensSetting lens_at(const StudioInfo& info, double time_s) {
  const double begin_s = info.empty_frames / info.rate_hz;
  const double end_s = std::max(begin_s + 1 / info.rate_hz, (info.frames - 1) / info.rate_hz);
  const double t = smooth_step((time_s - begin_s) / (end_s - begin_s));
  return {t, 0.5 + 0.35 * std::sin(1.5 * std::numbers::pi * t)};
}

LensCounts counts_of(const LensSetting& at) {
  return {kFirstCount + kZoomCounts * (0.6 * at.zoom + 0.4 * at.zoom * at.zoom),
          kFirstFocus + kFocusCounts * at.focus};
}

std::vector<LensSample> record_lens(const StudioOptions& options, const StudioInfo& info) {
  std::vector<LensSample> samples;
  const NormalTable normal;
  const double end_s = info.frames / info.rate_hz + 0.1;
  for (int i = 0; - 0.1 + kLensPhase_s + i / kLensRate_hz <= end_s; ++i) {
    const double time_s = -0.1 + kLensPhase_s + i / kLensRate_hz;
    const LensCounts exact = counts_of(lens_at(info, time_s));
    const std::uint64_t bits = hash_key(options.seed, kLensNoise, static_cast<unsigned>(i));
    const auto read = [&](double count, int shift) {
      return std::round(count + kCountSigma * static_cast<double>(normal(bits >> shift)));
    };
    samples.push_back({time_s, {read(exact.zoom, 0), read(exact.focus, 12)}});
  }
  return samples;
}

std::vector<LensTruth> true_lens_table(const StudioOptions& options, const StudioInfo& info) {
  constexpr int kZooms = 9, kFocuses = 4;
  const ZoomLens lens{info.target, options.zoom};
  std::vector<LensTruth> nodes;
  for (int i = 0; i < kZooms; ++i)
    for (int j = 0; j < kFocuses; ++j) {
      // A margin, so that the encoders' noise stays inside.
      const LensSetting at{-0.02 + 1.04 * i / (kZooms - 1), 0.1 + 0.8 * j / (kFocuses - 1)};
      nodes.push_back({counts_of(at), lens.optics(at), lens.pupil_shift_m(at)});
    }
  return nodes;
}

}  // namespace mixrig::studio
