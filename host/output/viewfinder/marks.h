// SPDX-License-Identifier: Apache-2.0
// What is drawn over a viewfinder's picture. Pure functions on pixels; nothing allocates. The
// fourth byte is the share that covers what lies below the picture, whose colours are multiplied by
// it: 255 of a whole picture, 0 where nothing was drawn over one that stays in the GPU.
#pragma once

#include "hal/base/image.h"

namespace mixrig::viewfinder {

inline constexpr int kPeakStep = 48;  ///< of 255: brightness differs so much at a sharp edge

/// Zebra: pixels with a saturated channel (capture::kSaturatedByte) get black diagonal stripes,
/// four pixels wide. Peaking: pixels whose brightness differs by at least kPeakStep, to the right
/// and downwards together, become red. Both are decided by the picture as it came.
void mark_exposure_and_focus(ImageView<Rgbx8> picture, bool zebra, bool peaking);

/// Lines of the thirds, a cross in the middle, and the borders of 90 and 80 % of the picture
/// (action and title), each one pixel wide, half white.
void draw_guides(ImageView<Rgbx8> picture);

/// Halves the light of the bytes in a rectangle; what lies outside of the picture is left out.
void darken(ImageView<Rgbx8> picture, int x, int y, Size size);

/// A frame of `width_px` along the border.
void draw_border(ImageView<Rgbx8> picture, int width_px, Rgb8 ink);

/// Dark grey with two diagonal lines: nobody takes it for a picture.
void draw_placeholder(ImageView<Rgbx8> picture);

}  // namespace mixrig::viewfinder
