// SPDX-License-Identifier: Apache-2.0
// Depth of field: the composite as a thin lens sees it, gathered in three layers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render::cpu {

/// Pixels of a row of a disc, from -half to +half of the middle, that count by `weight`.
struct FocusChord {
  int dy = 0, half = 0;
  float weight = 0;
};

/// Memory that frames reuse.
struct FocusScratch {
  /// One value a pixel, with a margin of `margin` all around.
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
  Plane w;          ///< 1/z; of a pixel without depth that of its row's neighbour
  Plane radius_px;  ///< of the disc; margins have none
  Plane share;      ///< 1 / (pixels that the disc covers); 0 in the margins
  /// Light, and pixels, of the row before a pixel: sums of a run are two of them.
  std::array<Plane, 4> before;
  std::vector<float> tile_radius_px, near_radius_px;  ///< greatest of a tile, and of those about it
  std::vector<std::uint8_t> tile_step, near_step;     ///< whether there are two surfaces
  std::vector<FocusChord> chords;                     ///< of discs of 0, 1/2, 1 ... px
  std::vector<std::size_t> chords_end;
  std::vector<float> disc_area;         ///< by radius, in steps of 1/16 px
  std::vector<std::uint8_t> srgb_byte;  ///< by linear light in steps of 1/65535
  float focus_w = 0;                    ///< of the last frame whose focus was known
};

/// Of one frame.
struct FocusPass {
  const FocusScratch& in;
  float blur_px_m = 0;           ///< radius over a difference of 1/z
  int stride_from_px = 1 << 20;  ///< the fast rung takes every second tap from twice this radius
};

/// Of 1/z between what is one surface and what is two: neighbours of which one has `w`.
float focus_step(float w, float blur_px_m);

/// `count` pixels of a row from x0, where discs of up to `radius_px` may be of several surfaces:
/// each tap is before, of, or behind the pixel's own.
void gather_focus_row(const FocusPass& pass, int x0, int y, int count, float radius_px,
                      Image<Rgb8>& to);
/// The same where all is one surface: sums of runs of the rows.
void blur_focus_row(const FocusPass& pass, int x0, int y, int count, Image<Rgb8>& to);

/// Replaces output.color by what a lens of focal length `fx_px` sees, by output.mixed_depth_m.
/// Each pixel is the sum of what lies before its surface (discs that reach it), its surface, and
/// what lies behind it: light of what is behind never spreads over what is sharp before it, and
/// what is blurred before spreads over what is sharp behind. What a surface hides is taken from
/// beside it. Does not allocate after the first frame.
void draw_focus(Crew& crew, const Focus& focus, double fx_px, FocusScratch& scratch,
                FrameOutput& output);

}  // namespace mixrig::render::cpu
