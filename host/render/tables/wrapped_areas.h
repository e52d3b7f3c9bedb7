// SPDX-License-Identifier: Apache-2.0
// What a mirror shows to a ToF camera: learned depth that hangs in the air.
#pragma once

#include "hal/base/image.h"

namespace mixrig::render {

/// A copy of a learned depth (metres, 0 unknown) in which what has wrapped around is a plane
/// through what lies behind its border. What is seen in a mirror lies beyond the camera's
/// unambiguous range and comes out nearer than the wall around the mirror, but with the noise of
/// its true distance. Such an area is joined without a step, has at least 0.2 % of the picture,
/// four fifths of its border lie before something farther, and its spread over the square of its
/// depth is at least five times the picture's median: what hangs in a room is hardly noisier than
/// the room, for its light. `sigma_m`: spread of one measurement, of the same size; where it is
/// empty nothing changes. Pure. Some 40 ns a pixel.
Image<float> without_wrapped(ImageView<const float> depth_m, ImageView<const float> sigma_m);

}  // namespace mixrig::render
