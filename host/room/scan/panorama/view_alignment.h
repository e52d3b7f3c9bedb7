// SPDX-License-Identifier: Apache-2.0
// Agreement of a sweep's views where they overlap, and small turns that improve it.
#pragma once

#include <span>
#include <vector>

#include "hal/base/parallel.h"
#include "host/math/geometry/camera_model.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Agreement of one view with its neighbours.
struct ViewAgreement {
  int samples = 0;       ///< held-out samples in overlaps with other views; 0: cannot be judged
  double median_m = 0;   ///< distance of its points to the others' surfaces, at the unit's angles
  double aligned_m = 0;  ///< that distance after all views were turned
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  ///< rotation vector, base axes; 0: none
};

/// Agreement of all views; distances are of held-out samples, at the unit's angles.
struct Alignment {
  std::vector<ViewAgreement> views;
  int samples = 0;
  double median_m = 0, p95_m = 0;
  double median_turn_rad = 0;  ///< of the turns that would make all views agree best
  bool refused = false;        ///< median_turn_rad exceeds the error of a unit: no view is turned
};

/// Estimates a small turn of each view around the origin of the base. In the overlaps, distances
/// (point to plane) and colours without their local mean must agree, coarse to fine, with robust
/// weights, since people and edges do not agree (analysis by synthesis, Schiller et al. 2010,
/// section 4.2, for all views at once). A third of the samples is held out: a view's turn is kept
/// where it lowers their error by more than a twentieth and is larger than `least_turn_rad`. A turn
/// that all views share cannot be observed; a robust prior on each turn lets views without error
/// stay. Where half of the views would turn by more than half a degree, depth and not the angles is
/// wrong (multipath bends walls), and no view is turned.
Alignment align(std::span<const ScanView> views, const geometry::CameraModel& tof,
                const geometry::CameraModel& target, double least_turn_rad, Crew& crew);

/// Turns a view by a rotation vector of align().
void turn(const Eigen::Vector3d& turn_rad, ScanView& view);

}  // namespace mixrig::model
