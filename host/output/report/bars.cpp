// SPDX-License-Identifier: Apache-2.0
#include "host/output/report/bars.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/output/report/canvas.h"
#include "host/output/report/plot.h"

namespace mixrig::report {
namespace {

constexpr int kBarLeft_px = 170, kBarRight_px = 40, kBarTop_px = 60, kBarBottom_px = 70;
constexpr Rgb8 kBarPaper{255, 255, 255}, kBarInk{40, 40, 40};
constexpr std::array<Rgb8, 6> kPartColors{{{60, 110, 170},
                                           {220, 140, 50},
                                           {90, 160, 90},
                                           {170, 80, 80},
                                           {130, 110, 170},
                                           {120, 120, 120}}};

double length_of(const Bar& bar) {
  double sum = 0;
  for (const BarPart& part : bar.parts) sum += part.value;
  return sum;
}

Rgb8 color_of(const BarPlot& plot, const std::string& name) {
  const std::vector<BarPart>& parts = plot.bars.front().parts;
  const auto found = std::find_if(parts.begin(), parts.end(),
                                  [&](const BarPart& part) { return part.name == name; });
  return kPartColors[static_cast<std::size_t>(found - parts.begin()) % kPartColors.size()];
}

void draw_bar(Canvas& canvas, const BarPlot& plot, const Bar& bar, double px_per_unit, int top_px,
              int height_px) {
  double from = 0;
  for (const BarPart& part : bar.parts) {
    const int left = kBarLeft_px + static_cast<int>(std::lround(from * px_per_unit));
    from += part.value;
    const int right = kBarLeft_px + static_cast<int>(std::lround(from * px_per_unit));
    if (right > left)
      canvas.picture(left, top_px,
                     Image<Rgb8>({right - left, height_px}, color_of(plot, part.name)));
  }
  canvas.text({kBarLeft_px - 10.0, top_px + 0.5 * height_px + 5}, bar.name, 14, kBarInk,
              Align::kRight);
  canvas.text({kBarLeft_px + from * px_per_unit + 6, top_px + 0.5 * height_px + 5},
              fmt::format("{:.1f}", from), 13, kBarInk);
}

}  // namespace

Image<Rgb8> draw_bars(const BarPlot& plot, Size size) {
  Canvas canvas(size, kBarPaper);
  canvas.text({20, 28}, plot.title, 18, kBarInk);
  if (plot.bars.empty()) return canvas.finish();
  double longest = 0;
  for (const Bar& bar : plot.bars) longest = std::max(longest, length_of(bar));
  const double step = tick_step(longest);
  const double end = step * std::max(1.0, std::ceil(longest / step * 1.02));
  const double px_per_unit = (size.width - kBarLeft_px - kBarRight_px) / end;
  const int bottom = size.height - kBarBottom_px;
  for (double tick = 0; tick <= end * (1 + 1e-9); tick += step) {
    const double x = kBarLeft_px + tick * px_per_unit;
    canvas.line({{x, kBarTop_px * 1.0}, {x, bottom * 1.0}}, 0.5, {190, 190, 190});
    canvas.text({x, bottom + 18.0}, fmt::format("{:g}", tick), 13, kBarInk, Align::kCenter);
  }
  canvas.text({size.width - kBarRight_px * 1.0, bottom + 36.0}, plot.unit, 13, kBarInk,
              Align::kRight);
  const int room_px = (bottom - kBarTop_px) / static_cast<int>(plot.bars.size());
  for (std::size_t i = 0; i < plot.bars.size(); ++i)
    draw_bar(canvas, plot, plot.bars[i], px_per_unit,
             kBarTop_px + static_cast<int>(i) * room_px + room_px / 6, room_px * 2 / 3);
  double x = 20;
  for (const BarPart& part : plot.bars.front().parts) {
    canvas.picture(static_cast<int>(x), size.height - 26,
                   Image<Rgb8>({12, 12}, color_of(plot, part.name)));
    canvas.text({x + 18, size.height - 15.0}, part.name, 13, kBarInk);
    x += 40 + 7.5 * static_cast<double>(part.name.size());
  }
  return canvas.finish();
}

}  // namespace mixrig::report
