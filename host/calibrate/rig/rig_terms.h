// SPDX-License-Identifier: Apache-2.0
// Residuals of a view: of its corners, or of every pixel of its pictures.
#pragma once

#include <vector>

#include "host/calibrate/rig/board_render.h"
#include "host/calibrate/rig/normal_equations.h"
#include "host/calibrate/rig/rig_model.h"
#include "host/calibrate/rig/view_set.h"

namespace mixrig::calibration {

/// A corner of the board and where a camera sees it.
struct SeenCorner {
  Eigen::Vector2d uv;  ///< on the board, in squares
  Eigen::Vector2d px;
};
/// Corners by view and camera; empty where the board was not found.
using SeenCorners = std::vector<std::vector<std::vector<SeenCorner>>>;

/// Pictures by view and camera; empty where the camera has none.
using Pictures = std::vector<std::vector<ViewPictures>>;

/// Makes the robust sums (Huber) of a view's corners. `sigma_px`: standard deviation for each
/// camera.
ViewFunction corner_terms(const BoardPrint& print, const SeenCorners& corners,
                          const std::vector<double>& sigma_px);

/// Sums over all pixels on the board of a view. The board is rendered into each picture with light
/// that varies as a quadratic over the board, separately for ink and paper, and is solved for in
/// the same step. The depth picture is compared with the distance of the board plus the depth
/// curve. Residuals are divided by their scatter in the start model, and weighted by Huber beyond
/// three sigma.
class PixelTerms {
 public:
  PixelTerms(const BoardPrint& print, const Pictures& pictures)
      : print_(print), pictures_(pictures) {}
  /// Finds which pictures show the board, and the scatter of their residuals.
  void weigh(const RigModel& model, const std::vector<int>& views, Crew& crew);
  ViewFunction function() const;
  /// Root mean square of a camera's grey residuals at the last weigh(), as a share of the contrast
  /// between paper and ink.
  double grey_rms(int camera) const;

  struct Weights {
    bool used = false;
    double grey = 0, contrast = 0;   ///< standard deviation of grey, and paper - ink
    double paper_m = 0, ink_m = 0;   ///< standard deviation of depth on paper and on ink
    std::vector<BoardPixel> pixels;  ///< on the board in the start model
  };

 private:
  ViewTerm sums(const RigModel& model, const RigLayout& layout, int view) const;

  const BoardPrint& print_;
  const Pictures& pictures_;
  std::vector<std::vector<Weights>> weights_;  ///< by view, then camera
};

/// Mean of a patch of a depth picture: on paper, on ink, or where both meet.
struct DepthSample {
  int view = 0;
  double measured_m = 0, board_m = 0;  ///< distance along the ray: measured, and by the model
  double amplitude = 0;                ///< in the picture's unit
  Eigen::Vector2d place{0, 0};         ///< position in the picture, -1..1
  double weight = 0;                   ///< number of pixels
};
std::vector<DepthSample> depth_samples(const BoardPrint& print, const Pictures& pictures,
                                       const RigModel& model, std::size_t camera,
                                       const std::vector<int>& views);

}  // namespace mixrig::calibration
