// SPDX-License-Identifier: Apache-2.0
// A motion capture system that tracks a body on the rig of a moving scenario.
#pragma once

#include <vector>

#include "host/math/geometry/pose.h"

namespace mixrig::studio {

struct StudioOptions;

/// The system's clock shows clock_offset_s + (1 + clock_drift) * time at a time of the take, whose
/// first frame is at 0. A pose is stamped on that clock when it is given out, which is delay_s
/// after the moment that it shows.
struct MocapSystem {
  double rate_hz = 120;
  double clock_offset_s = 0, clock_drift = 0;
  double delay_s = 0.008;
  double position_sigma_m = 0.0002;        ///< each axis
  double rotation_sigma_rad = 0;           ///< about each axis
  double lost_share = 0.02;                ///< samples that are not in the stream
  geometry::Pose body_from_target;         ///< the body's own axes are not the camera's
  std::vector<Eigen::Vector3d> markers_m;  ///< of the body, in its axes
  double marker_sigma_m = 0.0001;          ///< of an observed marker, each axis
  double hidden_share = 0.01;              ///< of the observations of a marker
};

/// Offset 20 to 120 s, drift within 50 parts in a million, body within 3 cm of a place above the
/// target camera, turned by up to 20 degrees.
MocapSystem mocap_of_seed(unsigned seed);

struct MocapSample {
  double stamp_s = 0;  ///< on the system's clock
  geometry::Pose world_from_body;
  std::vector<Eigen::Vector3d> markers_m;  ///< seen at the same time, world, in any order
};

/// Poses of the body from half a second before the first frame to half a second after the last one.
/// Depends on the options only. Empty for scenarios whose camera stands still.
std::vector<MocapSample> record_mocap(const StudioOptions& options, const MocapSystem& system);

}  // namespace mixrig::studio
