// SPDX-License-Identifier: Apache-2.0
// A virtual set that replaces the studio's room: a paved court with walls and columns, open to the
// sky.
#pragma once

#include "studio/studio.h"

namespace mixrig::studio {

/// Builds the court in world axes, floor at z = 0, about 12 x 12 m around the room.
VirtualObject build_court();
/// Sky over a horizon, for behind the court: sRGB.
Image<Rgb8> paint_sky(Size size);

}  // namespace mixrig::studio
