// SPDX-License-Identifier: Apache-2.0
#include "studio/mocap.h"

#include <cmath>

#include "hal/base/angles.h"
#include "studio/sensors/noise.h"
#include "studio/stage/layout.h"
#include "studio/studio.h"

namespace mixrig::studio {
namespace {

constexpr double kMargin_s = 0.5;  ///< recorded before and after the take
constexpr std::uint64_t kSystemKey = 0x30CA9, kSampleKey = 0x30CA5, kMarkerKey = 0x30CA3;

Eigen::Quaterniond turn_of(const Eigen::Vector3d& rotation_vector) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(rotation_vector.norm(), rotation_vector.stableNormalized()));
}

/// The body at a time of the take, as the system sees it.
geometry::Pose observe(const geometry::Pose& world_from_body, const MocapSystem& system,
                       std::uint64_t key, const NormalTable& normal) {
  std::uint64_t count = 0;
  const auto draw = [&] {
    const double x = normal(hash_key(key, ++count)), y = normal(hash_key(key, ++count));
    return Eigen::Vector3d(x, y, normal(hash_key(key, ++count)));
  };
  const Eigen::Vector3d shift = system.position_sigma_m * draw();
  const Eigen::Vector3d turn = system.rotation_sigma_rad * draw();
  return {world_from_body.rotation * turn_of(turn), world_from_body.translation_m + shift};
}

/// The markers that are not hidden; the first one changes from sample to sample.
std::vector<Eigen::Vector3d> observe_markers(const geometry::Pose& world_from_body,
                                             const MocapSystem& system, std::uint64_t key,
                                             const NormalTable& normal) {
  std::vector<Eigen::Vector3d> seen;
  const std::size_t count = system.markers_m.size(), first = hash_key(key, kMarkerKey) % count;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t own = hash_key(key, kMarkerKey, i + 1);
    if (uniform(hash_key(own, 0)) < system.hidden_share) continue;
    const double x = normal(hash_key(own, 1)), y = normal(hash_key(own, 2));
    seen.push_back(world_from_body * system.markers_m[(first + i) % count] +
                   system.marker_sigma_m * Eigen::Vector3d(x, y, normal(hash_key(own, 3))));
  }
  return seen;
}

}  // namespace

MocapSystem mocap_of_seed(unsigned seed) {
  std::uint64_t count = 0;
  const auto draw = [&] { return 2.0 * uniform(hash_key(seed, kSystemKey, ++count)) - 1; };
  const auto vector = [&] {
    const double x = draw(), y = draw();
    return Eigen::Vector3d(x, y, draw());
  };
  MocapSystem system;
  system.clock_offset_s = 70 + 50 * draw();
  system.clock_drift = 50e-6 * draw();
  system.rotation_sigma_rad = 0.02 * kDeg;
  const Eigen::Vector3d turn = 20 * kDeg / std::sqrt(3.0) * vector();
  const geometry::Pose target_from_body{turn_of(turn),
                                        Eigen::Vector3d(0.02, -0.09, -0.04) + 0.017 * vector()};
  system.body_from_target = geometry::inverse(target_from_body);
  system.markers_m = {
      {0, 0, 0}, {0.19, 0, 0.01}, {0.05, -0.15, 0}, {-0.11, -0.05, 0.06}, {0.03, -0.07, 0.12}};
  return system;
}

std::vector<MocapSample> record_mocap(const StudioOptions& options, const MocapSystem& system) {
  const Layout layout = make_layout(options);
  std::vector<MocapSample> samples;
  if (!layout.camera_moves) return samples;
  const NormalTable normal;
  const geometry::Pose target_from_body = geometry::inverse(system.body_from_target);
  const double length_s = (options.frames - 1) / kFrameRate_hz + 2 * kMargin_s;
  const auto count = static_cast<int>(length_s * system.rate_hz) + 1;
  for (int k = 0; k < count; ++k) {
    const std::uint64_t key = hash_key(options.seed, kSampleKey, static_cast<std::uint64_t>(k));
    if (uniform(hash_key(key, 0)) < system.lost_share) continue;
    // The system triggers by its own clock.
    const double time_s = k / system.rate_hz / (1 + system.clock_drift) - kMargin_s;
    const geometry::Pose body =
        camera_at(layout, options, time_s).world_from_target * target_from_body;
    const double given_out_s = time_s + system.delay_s;
    samples.push_back({system.clock_offset_s + (1 + system.clock_drift) * given_out_s,
                       observe(body, system, key, normal),
                       observe_markers(body, system, key, normal)});
  }
  return samples;
}

}  // namespace mixrig::studio
