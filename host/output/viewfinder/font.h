// SPDX-License-Identifier: Apache-2.0
// A built-in font of 5x7 pixels, so that text needs no font file.
#pragma once

#include <string_view>

#include "hal/base/image.h"

namespace mixrig::viewfinder {

inline constexpr int kGlyphWidth_px = 5, kGlyphHeight_px = 7;
inline constexpr int kAdvance_px = 6;  ///< distance from letter to letter

/// Whether pixel (x, y) of a letter, from its top left, is set. Characters other than printable
/// ASCII look like '?'. Preconditions: 0 <= x < 5, 0 <= y < 7.
bool glyph_pixel(char letter, int x, int y);

/// Size of a line of text whose letters have pixels `scale` wide.
Size text_size(std::string_view text, int scale);

/// Writes a line with its top left corner at (x, y), clipped to the picture.
void draw_text(ImageView<Rgbx8> picture, int x, int y, std::string_view text, int scale, Rgb8 ink);

}  // namespace mixrig::viewfinder
