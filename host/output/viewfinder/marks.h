// SPDX-License-Identifier: Apache-2.0
// Draws marks over a viewfinder's picture. Pure functions on pixels; nothing allocates. The fourth
// byte is the share that covers the layer below, and colours are premultiplied by it: 255 for a
// whole picture, 0 where nothing was drawn over a picture that stays in the GPU.
#pragma once

#include "hal/base/image.h"

namespace mixrig::viewfinder {
inline constexpr int kPeakStep = 48;  ///< of 255: least difference of brightness at a sharp edge

/// Zebra: pixels with a saturated channel (capture::kSaturatedByte) get black diagonal stripes,
/// four pixels wide. Peaking: pixels whose brightness differs by at least kPeakStep, to the right
/// and downwards together, become red. Both are decided on the unmarked picture.
void mark_exposure_and_focus(ImageView<Rgbx8> picture, bool zebra, bool peaking);

/// Draws the lines of the thirds, a central cross, and the borders of 90 and 80 % of the picture
/// (action and title), each one pixel wide, half white.
void draw_guides(ImageView<Rgbx8> picture);

/// Halves the light of the bytes in a rectangle, clipped to the picture.
void darken(ImageView<Rgbx8> picture, int x, int y, Size size);

/// Draws a frame of `width_px` along the border.
void draw_border(ImageView<Rgbx8> picture, int width_px, Rgb8 ink);

/// Fills the picture with dark grey and two diagonal lines, which nobody takes for a picture.
void draw_placeholder(ImageView<Rgbx8> picture);

}  // namespace mixrig::viewfinder
