// SPDX-License-Identifier: Apache-2.0
// A board as a camera's pixel sees it: ink and paper under a Gaussian footprint, in closed form.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace mixrig::calibration {

/// A printed board in its own axes: u to the right, v down, origin at the outer corner of the first
/// square. Lengths in squares. White squares of a ChArUco board hold the markers.
struct BoardPrint {
  int columns = 0, rows = 0;      ///< squares
  bool first_is_white = false;    ///< the first square is white; else black
  double marker = 0;              ///< side of a ChArUco marker in squares; 0 for a checkerboard
  int marker_cells = 0;           ///< across a marker, its black border counted
  std::vector<std::uint8_t> ink;  ///< markers cell by cell, one marker after the other: 1 = black
};

/// True where a square of the print is black.
inline bool is_black(const BoardPrint& print, int column, int row) {
  return ((column + row) % 2 == 0) != print.first_is_white;
}

/// Share of ink under a footprint and its derivatives.
struct InkShare {
  double ink = 0;  ///< 0 paper .. 1 ink
  Eigen::Vector2d d_uv{0, 0};
};

/// Mean of the print under a Gaussian of covariance `footprint` (squares^2) around (u, v). Exact in
/// the variances, first order in the covariance of u and v (Plackett 1954); markers of neighbouring
/// squares are left out.
InkShare ink_under(const BoardPrint& print, const Eigen::Vector2d& uv,
                   const Eigen::Matrix2d& footprint);

/// True where nothing within `reach` (squares) of (u, v) changes colour; `ink` is its colour.
bool is_plain(const BoardPrint& print, const Eigen::Vector2d& uv, const Eigen::Vector2d& reach,
              double& ink);

}  // namespace mixrig::calibration
