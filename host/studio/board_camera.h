// SPDX-License-Identifier: Apache-2.0
// How a camera sees the board: what share of every pixel's response falls on paper and on ink.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/geometry/pose.h"
#include "host/studio/board_pattern.h"
#include "host/studio/tracer.h"

namespace mixrig::studio {

/// Unit ray of a pixel in camera axes; false where the lens has none.
using RayFunction = std::function<bool(double u_px, double v_px, Eigen::Vector3d& ray)>;

/// What one pixel sees.
struct BoardPixel {
  float board = 0;  ///< share of the response on the board, 0..1
  float paper = 0;  ///< share of it on white paper, 0..board
  float u_m = 0, v_m = 0;
  float distance_m = 0;  ///< along the ray
  float cosine = 0;      ///< of ray and normal
};

/// A camera whose response to a point is a pixel's square blurred by a Gaussian of `blur_px`.
class BoardCamera {
 public:
  BoardCamera(Size size_px, RayFunction ray, double blur_px);
  Size size_px() const { return size_; }
  /// Ray through a pixel's centre; zero where the lens has none.
  const Eigen::Vector3f& ray(int x, int y) const {
    return rays_[static_cast<std::size_t>(y) * size_.width + x];
  }
  /// `board` is traced in board axes. Pixels row by row.
  void look(const TraceScene& board, const BoardPattern& pattern,
            const geometry::Pose& camera_from_board, Crew& crew, std::vector<BoardPixel>& pixels);

 private:
  static constexpr int kSide = 12, kSamples = kSide * kSide;
  struct View;
  BoardPixel centre(const View& view, int x, int y) const;
  void shares(const View& view, int x, int y, const std::vector<BoardPixel>& row_pixels,
              BoardPixel& pixel) const;
  void trace_shares(const View& view, int x, int y, BoardPixel& pixel) const;

  Size size_;
  RayFunction ray_;
  std::vector<Eigen::Vector3f> rays_;
  std::array<Vec2, kSamples> samples_;  ///< of equal weight, pixels from the centre
  float reach_px_ = 0;                  ///< of the outermost sample
};

}  // namespace mixrig::studio
