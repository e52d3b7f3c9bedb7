// SPDX-License-Identifier: Apache-2.0
// Draws quads of the warp's mesh: set up in batches, drawn in blocks of 4x4 pixels, nearest surface
// kept.
#pragma once

#include <array>

#include "hal/base/image.h"

namespace mixrig::render::cpu {

/// A vertex in the view, pixels; w: inverse depth, 0: unknown.
struct Vertex {
  float u, v, w;
};

/// Margin of the view's image to the right and below, because blocks of 4x4 pixels are written
/// whole.
inline constexpr int kViewMargin = 3;
inline Size with_margin(Size size) { return {size.width + kViewMargin, size.height + kViewMargin}; }

/// The view rows of a band. Blocks start at `last_y` at most, so that no band writes another's
/// rows.
struct Band {
  int y0, y1, width, last_y;
};

/// Quads to draw, stored as one array a coordinate, so that they are set up in parallel.
struct QuadBatch {
  static constexpr int kCapacity = 32;
  using Row = std::array<float, kCapacity>;

  bool full() const { return count == kCapacity; }
  /// Adds a quad by its four corners in order around. Precondition: not full.
  void push(const std::array<Vertex, 4>& corners);

  /// Rows hold corners 0 to 3 of the quads. A quad whose u are all negative is not drawn.
  alignas(64) std::array<Row, 4> u_px, v_px, w;
  int count = 0;
};

/// Draws both triangles of each quad (corners 0-1-2 and 0-2-3) that shows its front, where it is
/// nearer than `view_w`. `cut` marks the pixels (from_cut_cell). Both triangles include their
/// borders: the nearest-surface test makes double coverage harmless, and no crack is left. Writes
/// rows of the band only.
void draw_quads(const QuadBatch& quads, bool cut, const Band& band, Image<float>& view_w);

}  // namespace mixrig::render::cpu
