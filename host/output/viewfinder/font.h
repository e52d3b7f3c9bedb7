// SPDX-License-Identifier: Apache-2.0
// Letters of 5x7 pixels, so that a picture can be written on without a font file.
#pragma once

#include <string_view>

#include "hal/base/image.h"

namespace mixrig::viewfinder {

inline constexpr int kGlyphWidth_px = 5, kGlyphHeight_px = 7;
inline constexpr int kAdvance_px = 6;  ///< from letter to letter

/// Whether pixel (x, y) of a letter is set, from its top left. Characters that are not printable
/// ASCII look like '?'. Preconditions: 0 <= x < 5, 0 <= y < 7.
bool glyph_pixel(char letter, int x, int y);

/// Size of a line of text, each pixel of a letter `scale` pixels wide.
Size text_size(std::string_view text, int scale);

/// Writes a line with its top left corner at (x, y); what lies outside of the picture is left out.
void draw_text(ImageView<Rgbx8> picture, int x, int y, std::string_view text, int scale, Rgb8 ink);

}  // namespace mixrig::viewfinder
