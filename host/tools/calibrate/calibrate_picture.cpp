// SPDX-License-Identifier: Apache-2.0
#include "host/tools/calibrate/calibrate_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/output/report/canvas.h"
#include "host/output/report/picture.h"

namespace mixrig::tools {
namespace {

using calibration::Intrinsics;
using calibration::UncertaintyMap;
using calibration::ViewFit;
using report::Canvas;

constexpr Rgb8 kPaper{255, 255, 255}, kInk{30, 30, 30}, kFrame{200, 200, 200}, kPoint{31, 119, 180},
    kResidual{214, 96, 30}, kLeftOut{170, 170, 170};
constexpr double kPanel_px = 480, kTop_px = 50, kGap_px = 30;

/// A panel that shows the camera's picture: `scale` panel pixels per picture pixel.
struct Panel {
  double left_px, scale, height_px;
  report::Point at(double x, double y) const {
    return {left_px + (x + 0.5) * scale, kTop_px + (y + 0.5) * scale};
  }
};

Panel panel_of(Size size, int index) {
  const double scale = kPanel_px / size.width;
  return {kGap_px + index * (kPanel_px + kGap_px), scale, size.height * scale};
}

void frame(Canvas& canvas, const Panel& p, const std::string& title) {
  const double right = p.left_px + kPanel_px, bottom = kTop_px + p.height_px;
  canvas.line({{p.left_px, kTop_px},
               {right, kTop_px},
               {right, bottom},
               {p.left_px, bottom},
               {p.left_px, kTop_px}},
              1, kFrame);
  canvas.text({p.left_px, 34}, title, 15, kInk);
}

void draw_residuals(Canvas& canvas, const Panel& p, const Intrinsics& in) {
  // A residual of three sigma is drawn 20 panel pixels long.
  const double enlarged = 20 / std::max(3 * in.sigma_px, 1e-6);
  frame(canvas, p,
        fmt::format("residuals, {:.3f} px RMS, drawn {:.0f}-fold", in.rms_px, enlarged / p.scale));
  for (const ViewFit& view : in.views)
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      const report::Point from = p.at(view.px[i].x(), view.px[i].y());
      const Eigen::Vector2d r =
          view.residual_px[i] *
          std::min(1.0, 5 * in.sigma_px / std::max(view.residual_px[i].norm(), 1e-9));
      canvas.line({from, {from.x + enlarged * r.x(), from.y + enlarged * r.y()}}, 1, kResidual);
      canvas.dot(from, 1.5, kPoint);
    }
}

void draw_uncertainty(Canvas& canvas, const Panel& p, const Intrinsics& in,
                      const UncertaintyMap& map) {
  frame(canvas, p,
        fmt::format("uncertainty of projection, px: median {:.3f}, worst {:.3f}", map.median_px,
                    map.worst_px));
  const double width = kPanel_px / map.columns, height = p.height_px / map.rows;
  const auto counts = calibration::coverage(in, map.columns, map.rows);
  for (int r = 0; r < map.rows; ++r)
    for (int c = 0; c < map.columns; ++c) {
      const auto i = static_cast<std::size_t>(r * map.columns + c);
      if (!std::isfinite(map.sigma_px[i])) continue;
      const double x = p.left_px + c * width, y = kTop_px + r * height;
      Image<Rgb8> cell({static_cast<int>(std::ceil(width)), static_cast<int>(std::ceil(height))},
                       report::error_color(static_cast<float>(map.sigma_px[i])));
      canvas.picture(static_cast<int>(x), static_cast<int>(y), cell);
      canvas.text({x + width / 2, y + height / 2}, fmt::format("{:.2f}", map.sigma_px[i]), 11, kInk,
                  report::Align::kCenter);
      canvas.text({x + width / 2, y + height / 2 + 13}, fmt::format("{} pts", counts[i]), 9, kInk,
                  report::Align::kCenter);
    }
}

void draw_views(Canvas& canvas, const Panel& p, const Intrinsics& in) {
  double worst = 1e-6;
  for (const ViewFit& view : in.views) worst = std::max(worst, view.rms_px);
  frame(canvas, p, fmt::format("error of every view, px RMS; longest bar {:.3f}", worst));
  const double step = p.height_px / static_cast<double>(std::max<std::size_t>(in.views.size(), 1));
  const double text_px = std::clamp(0.7 * step, 6.0, 12.0);
  for (std::size_t v = 0; v < in.views.size(); ++v) {
    const ViewFit& view = in.views[v];
    const double y = kTop_px + (static_cast<double>(v) + 0.5) * step, left = p.left_px + 150;
    canvas.text({left - 6, y + text_px / 3}, view.name, text_px, view.used ? kInk : kLeftOut,
                report::Align::kRight);
    if (view.used)
      canvas.line({{left, y}, {left + (kPanel_px - 220) * view.rms_px / worst, y}}, 0.6 * step,
                  kPoint);
    canvas.text({p.left_px + kPanel_px - 4, y + text_px / 3},
                view.used ? fmt::format("{:.3f}", view.rms_px) : "left out", text_px,
                view.used ? kInk : kLeftOut, report::Align::kRight);
  }
}

}  // namespace

Image<Rgb8> calibration_picture(const Intrinsics& in, const UncertaintyMap& map) {
  const Size size = geometry::size_px(in.camera);
  const Panel first = panel_of(size, 0);
  Canvas canvas({static_cast<int>(3 * kPanel_px + 4 * kGap_px),
                 static_cast<int>(kTop_px + first.height_px + kGap_px)},
                kPaper);
  draw_residuals(canvas, first, in);
  draw_uncertainty(canvas, panel_of(size, 1), in, map);
  draw_views(canvas, panel_of(size, 2), in);
  return canvas.finish();
}

}  // namespace mixrig::tools
