// SPDX-License-Identifier: Apache-2.0
// Paints the colours of a panorama whose distances are known. Private to this module.
#pragma once

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Paints the mean linear colour of the views that see the surface, weighted towards the middle of
/// their pictures, with `factor` times as many pixels a side as distances. A view whose depth
/// camera sees something before the surface does not count; a view that measured nothing there
/// counts only where no view sees the surface. Places that no target camera sees stay black.
/// `panorama.gains` makes the views equally bright where it is not empty. Where some view has
/// ScanView::light, panorama.light is made in the same way, from unsaturated values where any view
/// has them.
void paint(std::span<const ScanView> views, const geometry::CameraModel& tof,
           const geometry::CameraModel& target, int factor, Panorama& panorama, Crew& crew);

/// Distance at a position (`x`, `y` in pixels, columns go around) between the pixels of a panorama.
/// Along a surface the inverse distance is interpolated; at a depth step the nearest pixel's
/// distance is taken.
float distance_between(const Panorama& panorama, double x, double y);

}  // namespace mixrig::model
