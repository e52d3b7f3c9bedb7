// SPDX-License-Identifier: Apache-2.0
// Colours of a panorama whose distances are known. Private to this module.
#pragma once

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Mean linear colour of the views that see the surface, weighted towards the middle of their
/// pictures; `factor` times as many pixels a side as distances. A view whose depth camera sees
/// something before the surface does not count; one that measured nothing there only where no view
/// sees it. What no target camera sees stays black. `panorama.gains` makes the views equally bright
/// where it is not empty. Where some view has ScanView::light, panorama.light is made in the same
/// way, from what is not saturated where any view has that.
void paint(std::span<const ScanView> views, const geometry::CameraModel& tof,
           const geometry::CameraModel& target, int factor, Panorama& panorama, Crew& crew);

/// The distance between the pixels of a panorama: along a surface its inverse is interpolated, at
/// a depth step the nearest pixel's is taken. `x`, `y` in pixels; columns go around.
float distance_between(const Panorama& panorama, double x, double y);

}  // namespace mixrig::model
