// SPDX-License-Identifier: Apache-2.0
// A camera's view of the board: the share of paper and ink in the response of every pixel.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/math/geometry/pose.h"
#include "studio/board/board_pattern.h"
#include "studio/tracer.h"

namespace mixrig::studio {

/// Unit ray of a pixel in camera axes; false if the lens has no ray there.
using RayFunction = std::function<bool(double u_px, double v_px, Eigen::Vector3d& ray)>;

/// The board in one pixel.
struct BoardPixel {
  float board = 0;  ///< share of the pixel's response on the board, 0..1
  float paper = 0;  ///< share of the response on white paper, 0..board
  float u_m = 0, v_m = 0;
  float distance_m = 0;  ///< along the ray
  float cosine = 0;      ///< of the angle between ray and normal
};

/// Which of a pixel's samples are taken: every n-th one, n = 1..16.
struct SampleSteps {
  int border = 1;  ///< of pixels on the board's outline
  int edge = 1;    ///< of pixels on the edges of its squares
};

/// A camera whose point response is a pixel's square convolved with a Gaussian of sigma `blur_px`.
class BoardCamera {
 public:
  BoardCamera(Size size_px, RayFunction ray, double blur_px);
  Size size_px() const { return size_; }
  /// Ray through a pixel's centre; zero if the lens has no ray there.
  const Eigen::Vector3f& ray(int x, int y) const {
    return rays_[static_cast<std::size_t>(y) * size_.width + x];
  }
  /// Traces `board`, which is given in board axes. `pixels` is filled row by row.
  void trace(const TraceScene& board, const BoardPattern& pattern,
             const geometry::Pose& camera_from_board, const SampleSteps& steps, Crew& crew,
             std::vector<BoardPixel>& pixels);

 private:
  static constexpr int kSide = 12, kSamples = kSide * kSide;
  struct View;
  BoardPixel centre(const View& view, int x, int y) const;
  void find_shares(const View& view, int x, int y, const std::vector<BoardPixel>& row_pixels,
                   BoardPixel& pixel) const;
  void trace_shares(const View& view, int x, int y, BoardPixel& pixel) const;

  Size size_;
  RayFunction ray_;
  std::vector<Eigen::Vector3f> rays_;
  std::array<Vec2, kSamples> samples_;  ///< offsets from the pixel centre, px, of equal weight
  float reach_px_ = 0;                  ///< largest offset of a sample
};

}  // namespace mixrig::studio
