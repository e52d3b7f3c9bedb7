// SPDX-License-Identifier: Apache-2.0
// How well the views of a sweep agree where they overlap, and the turns that make them agree.
#pragma once

#include <span>
#include <vector>

#include "hal/base/parallel.h"
#include "host/math/geometry/camera_model.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// What its neighbours say of one view.
struct ViewAgreement {
  int samples = 0;       ///< held out, in overlaps with other views; 0: nothing can be said
  double median_m = 0;   ///< distance of its points to the others' surfaces, as the unit says
  double aligned_m = 0;  ///< the same after the turns of all views
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  ///< rotation vector, base axes; 0: none
};

/// Agreement of all views; distances are of held-out samples, as the unit says.
struct Alignment {
  std::vector<ViewAgreement> views;
  int samples = 0;
  double median_m = 0, p95_m = 0;
  double median_turn_rad = 0;  ///< of the turns that would make all views agree, as far as they can
  bool refused = false;        ///< that is more than a unit errs by: no view has a turn
};

/// Estimates a small turn of each view around the origin of the base: distances (point to plane)
/// and colours without their local mean have to agree in the overlaps, coarse to fine, with robust
/// weights, since people and edges do not (analysis by synthesis, Schiller et al. 2010, section
/// 4.2, for all views at once). A third of the samples is held out: a view's turn is kept where it
/// lowers their error by more than a twentieth and is larger than `least_turn_rad`. The turns'
/// common part cannot be seen; a robust prior on each keeps it with those that need none. Where
/// half of the views would turn by more than half a degree, depth is wrong, not angles (light that
/// comes by way of other surfaces bends walls), and none is turned.
Alignment align(std::span<const ScanView> views, const geometry::CameraModel& tof,
                const geometry::CameraModel& target, double least_turn_rad, Crew& crew);

/// Turns a view by alignment's rotation vector.
void turn(const Eigen::Vector3d& turn_rad, ScanView& view);

}  // namespace mixrig::model
