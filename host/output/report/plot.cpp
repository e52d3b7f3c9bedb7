// SPDX-License-Identifier: Apache-2.0
#include "host/output/report/plot.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/output/report/canvas.h"

namespace mixrig::report {
namespace {

constexpr Rgb8 kPaper{255, 255, 255}, kInk{30, 30, 30}, kGrid{225, 225, 225};
constexpr std::array<Rgb8, 6> kColors{
    {{31, 119, 180}, {214, 96, 30}, {44, 140, 60}, {170, 40, 60}, {120, 90, 170}, {110, 80, 60}}};
constexpr double kLeft_px = 78, kRight_px = 30, kTop_px = 46, kBottom_px = 58;

bool drawable(const Plot& plot, const PlotPoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && p.x >= 0.0 && p.y >= 0.0 &&
         !(plot.log_x && p.x == 0.0);
}

/// Positions along it: a value, or its decimal logarithm.
struct Axis {
  double step = 1, begin = 0, end = 1;
  double from_px = 0, to_px = 1;
  bool log = false;
  double px(double value) const {
    return from_px +
           (to_px - from_px) * ((log ? std::log10(value) : value) - begin) / (end - begin);
  }
  double tick(int i) const { return log ? std::pow(10.0, begin + i * step) : i * step; }
  int ticks() const { return 1 + static_cast<int>(std::lround((end - begin) / step)); }
};

Axis decades(double least, double largest, double from_px, double to_px) {
  Axis axis{1, std::floor(std::log10(least)), std::ceil(std::log10(largest)), from_px, to_px, true};
  axis.end = std::max(axis.end, axis.begin + 1);
  return axis;
}

Axis axis_for(double largest, double from_px, double to_px) {
  Axis axis;
  axis.step = tick_step(largest);
  axis.end = axis.step * std::max(1.0, std::ceil(largest / axis.step));
  axis.from_px = from_px;
  axis.to_px = to_px;
  return axis;
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

void draw_axes(Canvas& canvas, const Plot& plot, const Axis& x, const Axis& y) {
  for (int i = 0; i < x.ticks(); ++i) {
    const double px = x.px(x.tick(i));
    canvas.line({{px, y.from_px}, {px, y.to_px}}, 1, kGrid);
    canvas.text({px, y.from_px + 18}, number(x.tick(i)), 13, kInk, Align::kCenter);
  }
  for (int i = 0; i < y.ticks(); ++i) {
    const double px = y.px(y.tick(i));
    canvas.line({{x.from_px, px}, {x.to_px, px}}, 1, kGrid);
    canvas.text({x.from_px - 8, px + 4}, number(y.tick(i)), 13, kInk, Align::kRight);
  }
  canvas.line({{x.from_px, y.to_px}, {x.from_px, y.from_px}, {x.to_px, y.from_px}}, 1.5, kInk);
  canvas.text({(x.from_px + x.to_px) / 2, 26}, plot.title, 17, kInk, Align::kCenter);
  canvas.text({(x.from_px + x.to_px) / 2, y.from_px + 42}, plot.x_label, 15, kInk, Align::kCenter);
  canvas.vertical_text({24, (y.from_px + y.to_px) / 2}, plot.y_label, 15, kInk);
}

/// `label_px`: vertical offset of labels, so that labels of series with a common point do not
/// overlap.
void draw_series(Canvas& canvas, const Plot& plot, const PlotSeries& series, Rgb8 color,
                 double label_px, const Axis& x, const Axis& y) {
  std::vector<Point> line;
  for (const PlotPoint& p : series.points) {
    if (!drawable(plot, p)) continue;
    const Point at{x.px(p.x), y.px(p.y)};
    line.push_back(at);
    canvas.dot(at, 4.5, color);
    canvas.text({at.x + 7, at.y + label_px}, p.label, 12, color);
  }
  if (plot.joined) canvas.line(line, 1.5, color);
}

void draw_on(Canvas& canvas, const Plot& plot, Size size) {
  double least_x = 0, largest_x = 0, largest_y = 0;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& p : series.points) {
      if (!drawable(plot, p)) continue;
      least_x = least_x > 0 ? std::min(least_x, p.x) : p.x;
      largest_x = std::max(largest_x, p.x);
      largest_y = std::max(largest_y, p.y);
    }
  }
  const double right_px = size.width - kRight_px;
  const Axis x = plot.log_x && least_x > 0 ? decades(least_x, largest_x, kLeft_px, right_px)
                                           : axis_for(largest_x, kLeft_px, right_px);
  const Axis y = axis_for(largest_y, size.height - kBottom_px, kTop_px);
  draw_axes(canvas, plot, x, y);
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Rgb8 color = kColors[i % kColors.size()];
    draw_series(canvas, plot, plot.series[i], color, -6 + 14 * static_cast<double>(i), x, y);
    canvas.text({x.to_px, kTop_px + 16 + 18.0 * static_cast<double>(i)}, plot.series[i].name, 14,
                color, Align::kRight);
  }
}

}  // namespace

double tick_step(double largest) {
  if (!(largest > 0.0) || !std::isfinite(largest)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(largest / 8.0)));
  for (double factor : {1.0, 2.0, 5.0})
    if (factor * power * 8.0 >= largest * (1 - 1e-12)) return factor * power;
  return 10.0 * power;
}

Image<Rgb8> draw(const Plot& plot, Size size) {
  Canvas canvas(size, kPaper);
  draw_on(canvas, plot, size);
  return canvas.finish();
}

std::string draw_svg(const Plot& plot, Size size) {
  Canvas canvas(size, kPaper, CanvasKind::kSvg);
  draw_on(canvas, plot, size);
  return canvas.finish_svg();
}

}  // namespace mixrig::report
