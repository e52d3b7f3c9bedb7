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
  /// Filled with `paper`.
  Canvas(Size size, Rgb8 paper, CanvasKind kind = CanvasKind::kPicture);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  /// Only on a picture.
  void picture(int x, int y, ImageView<const Rgb8> picture);
  /// `at` is on the base line; sans serif of `height_px`.
  void text(Point at, const std::string& words, double height_px, Rgb8 ink,
            Align align = Align::kLeft);
  /// The same, read from bottom to top.
  void vertical_text(Point at, const std::string& words, double height_px, Rgb8 ink);
  void line(const std::vector<Point>& points, double width_px, Rgb8 ink);
  void dot(Point at, double radius_px, Rgb8 ink);
  Image<Rgb8> finish();
  /// The file, of kSvg; nothing is drawn after it.
  std::string finish_svg();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::report
