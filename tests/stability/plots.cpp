// SPDX-License-Identifier: Apache-2.0
// The plot of the suite, as SVG drawn by cairo.
#include <algorithm>
#include <cmath>

#include <cairo-svg.h>
#include <fmt/format.h>

#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

constexpr double kMost = 2.0;  // upper end of the axis of both measures

/// Colours as 0xRRGGBB.
enum Ink : unsigned {
  kBlack = 0x000000,
  kBound = 0x223366,
  kNees = 0xcc3333,
  kGrid = 0xcccccc,
  kOk = 0x44aa44,
  kWeak = 0xeebb44,
  kRefused = 0xaaaaaa
};

enum class Align { kLeft, kMiddle, kRight };

/// A white page with x to the right and y down, in pixels.
class Page {
 public:
  Page(double width, double height)
      : surface_(cairo_svg_surface_create_for_stream(&Page::append, &svg_, width, height)),
        context_(cairo_create(surface_)) {
    cairo_svg_surface_set_document_unit(surface_, CAIRO_SVG_UNIT_PX);
    cairo_set_source_rgb(context_, 1, 1, 1);
    cairo_paint(context_);
    cairo_set_font_size(context_, 11);
  }
  ~Page() {
    cairo_destroy(context_);
    cairo_surface_destroy(surface_);
  }
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  void box(double x, double y, double width, double height, Ink ink) {
    cairo_rectangle(context_, x, y, width, height);
    fill(ink);
  }
  void line(double x1, double y1, double x2, double y2, Ink ink, double width) {
    set(ink);
    cairo_set_line_width(context_, width);
    cairo_move_to(context_, x1, y1);
    cairo_line_to(context_, x2, y2);
    cairo_stroke(context_);
  }
  void dot(double x, double y, Ink ink) {
    cairo_arc(context_, x, y, 3.5, 0, 2 * M_PI);
    fill(ink);
  }
  void diamond(double x, double y, Ink ink) {
    cairo_move_to(context_, x, y - 4);
    for (const auto& [dx, dy] : {std::pair(4, 0), std::pair(0, 4), std::pair(-4, 0)})
      cairo_line_to(context_, x + dx, y + dy);
    cairo_close_path(context_);
    fill(ink);
  }
  /// Writes a text; `y` is that of its base line.
  void text(double x, double y, const std::string& words, Align align, bool bold = false) {
    cairo_select_font_face(context_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_text_extents_t extents;
    cairo_text_extents(context_, words.c_str(), &extents);
    const double share = align == Align::kLeft ? 0 : align == Align::kMiddle ? 0.5 : 1;
    set(kBlack);
    cairo_move_to(context_, x - share * extents.x_advance, y);
    cairo_show_text(context_, words.c_str());
  }
  /// Ends the page; nothing is drawn after it. Empty if cairo failed.
  std::string finish() {
    cairo_surface_finish(surface_);
    return cairo_surface_status(surface_) == CAIRO_STATUS_SUCCESS ? std::move(svg_) : std::string();
  }

 private:
  static cairo_status_t append(void* svg, const unsigned char* bytes, unsigned count) {
    static_cast<std::string*>(svg)->append(reinterpret_cast<const char*>(bytes), count);
    return CAIRO_STATUS_SUCCESS;
  }
  void set(Ink ink) {
    const auto part = [&](int shift) { return ((ink >> shift) & 255U) / 255.0; };
    cairo_set_source_rgb(context_, part(16), part(8), part(0));
  }
  void fill(Ink ink) {
    set(ink);
    cairo_fill(context_);
  }

  std::string svg_;
  cairo_surface_t* surface_;
  cairo_t* context_;
};

double shown_at(double value) { return std::clamp(value, 0.0, kMost); }

/// Shares of ok, weak and refused as a bar.
void draw_verdicts(Page& page, const Row& row, double x, double y, double width, double height) {
  const double all = std::max(1, row.ok + row.weak + row.refused);
  double at = x;
  const auto bar = [&](int count, Ink ink) {
    const double share = width * count / all;
    page.box(at, y, share, height, ink);
    at += share;
  };
  bar(row.ok, kOk);
  bar(row.weak, kWeak);
  bar(row.refused, kRefused);
}

using Sweep = std::vector<Row>;

std::vector<Sweep> sweeps_of(const Report& report) {
  std::vector<Sweep> sweeps;
  for (const Row& row : report.rows) {
    if (row.axis.empty()) continue;
    if (sweeps.empty() || sweeps.back().front().axis != row.axis ||
        sweeps.back().front().estimator != row.estimator)
      sweeps.emplace_back();
    sweeps.back().push_back(row);
  }
  return sweeps;
}

/// One panel: the degeneracy grows to the right, on a logarithmic axis.
void draw_panel(Page& page, const Sweep& sweep, double x0, double y0) {
  constexpr double kWidth = 330, kHeight = 150;
  const double first = std::log10(sweep.front().at), last = std::log10(sweep.back().at);
  const auto x = [&](const Row& r) {
    return x0 + kWidth * (std::log10(r.at) - first) / (last - first);
  };
  const auto y = [&](double value) { return y0 + kHeight * (1 - shown_at(value) / kMost); };
  page.text(x0, y0 - 8, sweep.front().estimator, Align::kLeft, true);
  for (const double value : {0.0, 1.0, 2.0}) {
    page.line(x0, y(value), x0 + kWidth, y(value), kGrid, 1);
    page.text(x0 - 5, y(value) + 4, fmt::format("{:.0f}", value), Align::kRight);
  }
  for (const Row& r : sweep) {
    page.text(x(r), y0 + kHeight + 32, shown(r.at), Align::kMiddle);
    draw_verdicts(page, r, x(r) - 16, y0 + kHeight + 8, 32, 10);
    if (!std::isnan(r.nees)) page.dot(x(r), y(r.nees), kNees);
    if (!std::isnan(r.over_bound)) page.diamond(x(r), y(r.over_bound), kBound);
  }
  page.text(x0 + kWidth / 2, y0 + kHeight + 48, sweep.front().axis, Align::kMiddle);
}

std::string legend() {
  return "blue diamond: error / Cramer-Rao bound; red dot: NEES / degree of freedom; "
         "bar: ok (green), weak (yellow), refused (grey)";
}

}  // namespace

std::string sweeps_svg(const Report& report) {
  constexpr double kAcross = 420, kDown = 240;
  const auto sweeps = sweeps_of(report);
  Page page(2 * kAcross + 20, 40 + kDown * static_cast<double>((sweeps.size() + 1) / 2));
  page.text(20, 18, legend(), Align::kLeft);
  for (std::size_t i = 0; i < sweeps.size(); ++i)
    draw_panel(page, sweeps[i], 50 + kAcross * static_cast<double>(i % 2),
               60 + kDown * static_cast<double>(i / 2));
  return page.finish();
}

}  // namespace mixrig::estimation_bench
