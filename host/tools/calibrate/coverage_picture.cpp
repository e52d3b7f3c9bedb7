// SPDX-License-Identifier: Apache-2.0
#include "host/tools/calibrate/coverage_picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/output/report/canvas.h"

namespace mixrig::tools {
namespace {

using calibration::CoveredCamera;
using calibration::ViewRole;
using report::Canvas;

constexpr Rgb8 kSheet{255, 255, 255}, kLetters{30, 30, 30}, kRim{200, 200, 200},
    kCorner{31, 119, 180}, kLacking{255, 226, 205}, kOpen{200, 80, 20};
constexpr double kCameraWidth_px = 400, kAbove_px = 44, kBetween_px = 24, kLine_px = 17;
constexpr int kCells = 3;

/// Position of a camera's panel, and panel pixels per picture pixel.
struct CameraPanel {
  double left_px = 0, scale = 1, height_px = 0;
  report::Point at(const Eigen::Vector2d& px) const {
    return {left_px + (px.x() + 0.5) * scale, kAbove_px + (px.y() + 0.5) * scale};
  }
};

CameraPanel panel_of(const CoveredCamera& camera, std::size_t index) {
  const double scale = kCameraWidth_px / camera.size_px.width;
  return {kBetween_px + static_cast<double>(index) * (kCameraWidth_px + kBetween_px), scale,
          scale * camera.size_px.height};
}

/// Ninths whose need is not met; `need` is the index of the first one's.
void shade(Canvas& canvas, const CameraPanel& panel, const std::vector<calibration::Need>& needs,
           std::size_t need) {
  const double width = kCameraWidth_px / kCells, height = panel.height_px / kCells;
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column) {
      if (needs[need + static_cast<std::size_t>(kCells * row + column)].met()) continue;
      const Image<Rgb8> cell(
          {static_cast<int>(std::ceil(width)), static_cast<int>(std::ceil(height))}, kLacking);
      canvas.picture(static_cast<int>(panel.left_px + column * width),
                     static_cast<int>(kAbove_px + row * height), cell);
    }
}

void draw_boards(Canvas& canvas, const CameraPanel& panel, const calibration::Coverage& coverage,
                 std::size_t camera) {
  int shown = 0;
  for (const calibration::SeenBoards& seen : coverage.views()) {
    if (!seen[camera]) continue;
    ++shown;
    for (const Eigen::Vector2d& px : seen[camera]->px) canvas.dot(panel.at(px), 1.4, kCorner);
  }
  const double right = panel.left_px + kCameraWidth_px, bottom = kAbove_px + panel.height_px;
  canvas.line({{panel.left_px, kAbove_px},
               {right, kAbove_px},
               {right, bottom},
               {panel.left_px, bottom},
               {panel.left_px, kAbove_px}},
              1, kRim);
  canvas.text({panel.left_px, 30},
              fmt::format("{}: {} views", coverage.cameras()[camera].name, shown), 15, kLetters);
}

void list_needs(Canvas& canvas, double left_px, const std::vector<calibration::Need>& needs) {
  canvas.text({left_px, 30}, "what there is of what is wanted", 15, kLetters);
  double y = kAbove_px + 14;
  for (const calibration::Need& need : needs) {
    canvas.text({left_px, y}, fmt::format("{} of {}  {}", need.have, need.wanted, need.what), 12,
                need.met() ? kLetters : kOpen);
    y += kLine_px;
  }
}

}  // namespace

Image<Rgb8> coverage_picture(const calibration::Coverage& coverage) {
  const auto& cameras = coverage.cameras();
  double height_px = kLine_px * static_cast<double>(coverage.needs().size());
  for (std::size_t c = 0; c < cameras.size(); ++c)
    height_px = std::max(height_px, panel_of(cameras[c], c).height_px);
  const double width_px =
      kBetween_px + static_cast<double>(cameras.size() + 1) * (kCameraWidth_px + kBetween_px);
  Canvas canvas({static_cast<int>(width_px), static_cast<int>(kAbove_px + height_px + kBetween_px)},
                kSheet);
  std::size_t need = 1;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const CameraPanel panel = panel_of(cameras[c], c);
    if (cameras[c].role != ViewRole::kFisheye) {
      shade(canvas, panel, coverage.needs(), need);
      need += kCells * kCells;
    }
    draw_boards(canvas, panel, coverage, c);
  }
  list_needs(canvas,
             kBetween_px + static_cast<double>(cameras.size()) * (kCameraWidth_px + kBetween_px),
             coverage.needs());
  return canvas.finish();
}

}  // namespace mixrig::tools
