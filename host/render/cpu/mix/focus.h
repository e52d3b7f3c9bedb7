// SPDX-License-Identifier: Apache-2.0
// Pass focus: the composite through a thin lens, gathered in three layers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render::cpu {

/// Pixels of one row of a disc, -half to +half from its centre, that count by `weight`.
struct FocusChord {
  int dy = 0, half = 0;
  float weight = 0;
};

/// Memory reused from frame to frame.
struct FocusScratch {
  /// One value a pixel, with `margin` pixels all around.
  struct Plane {
    std::vector<float> values;
    std::size_t stride = 0;
    int margin = 0;
    void reset(Size size, int margin_px);
    float* row(int y) {
      return values.data() + static_cast<std::size_t>(y + margin) * stride +
             static_cast<std::size_t>(margin);
    }
    const float* row(int y) const { return const_cast<Plane*>(this)->row(y); }
  };
  Plane r, g, b;    ///< linear light, 1 = white, times `share`
  Plane w;          ///< 1/z; a pixel without depth takes that of its left neighbour
  Plane radius_px;  ///< radius of the pixel's disc; 0 in the margins
  Plane share;      ///< 1 / (area of the disc in pixels); 0 in the margins
  /// Running sums, along a row, of light and pixel count before a pixel: a run is the difference of
  /// two.
  std::array<Plane, 4> before;
  std::vector<float> tile_radius_px, near_radius_px;  ///< largest radius in a tile, and around it
  /// Whether a tile, or those around it, show two surfaces.
  std::vector<std::uint8_t> tile_step, near_step;
  std::vector<FocusChord> chords;  ///< of discs with radius 0, 1/2, 1 ... px
  std::vector<std::size_t> chords_end;
  std::vector<float> disc_area;         ///< by radius, in steps of 1/16 px
  std::vector<std::uint8_t> srgb_byte;  ///< by linear light, in steps of 1/65535
  float focus_w = 0;                    ///< of the last frame with a known focus
};

/// Inputs of the rows of one frame.
struct FocusPass {
  const FocusScratch& in;
  float blur_px_m = 0;  ///< disc radius, px, for each 1/m of difference of 1/z to the focus
  /// Radius, px: from twice of it on every second tap is taken (Focus::fast).
  int stride_from_px = 1 << 20;
};

/// Difference of 1/z to a pixel with `w` from which on a neighbour is another surface.
float focus_step(float w, float blur_px_m);

/// Computes `count` pixels of a row from x0 on, where discs of up to `radius_px` may belong to
/// several surfaces: each tap lies before, on, or behind the pixel's own surface.
void gather_focus_row(const FocusPass& pass, int x0, int y, int count, float radius_px,
                      Image<Rgb8>& to);
/// Computes pixels around which there is only one surface, by differences of running sums.
void blur_focus_row(const FocusPass& pass, int x0, int y, int count, Image<Rgb8>& to);

/// Replaces output.color by what a lens of focal length `fx_px` sees, by output.mixed_depth_m. Each
/// pixel sums the light before its surface (discs that reach it), on it, and behind it: light from
/// behind never spreads over something sharp before it, while something blurred in front spreads
/// over what is sharp behind. What a surface hides is taken from beside it. Does not allocate after
/// the first frame.
void draw_focus(Crew& crew, const Focus& focus, double fx_px, FocusScratch& scratch,
                FrameOutput& output);

}  // namespace mixrig::render::cpu
