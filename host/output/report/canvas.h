// SPDX-License-Identifier: Apache-2.0
// A small drawing surface on cairo for contact sheets and plots.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::report {

struct Point {
  double x = 0, y = 0;
};

enum class CanvasKind { kPicture, kSvg };

enum class Align { kLeft, kCenter, kRight };

/// Coordinates in pixels from the top left corner. Not thread-safe.
class Canvas {
 public:
  /// Makes a canvas filled with `paper`.
  Canvas(Size size, Rgb8 paper, CanvasKind kind = CanvasKind::kPicture);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  /// Draws a picture with its top left corner at (x, y). Only for CanvasKind::kPicture.
  void picture(int x, int y, ImageView<const Rgb8> picture);
  /// Writes sans serif text of `height_px`; `at` lies on the base line.
  void text(Point at, const std::string& words, double height_px, Rgb8 ink,
            Align align = Align::kLeft);
  /// Writes text that reads from bottom to top.
  void vertical_text(Point at, const std::string& words, double height_px, Rgb8 ink);
  void line(const std::vector<Point>& points, double width_px, Rgb8 ink);
  void dot(Point at, double radius_px, Rgb8 ink);
  Image<Rgb8> finish();
  /// Returns the file of a CanvasKind::kSvg canvas; nothing may be drawn afterwards.
  std::string finish_svg();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::report
