// SPDX-License-Identifier: Apache-2.0
// The plots of the suite, as SVG text.
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "host/estimation_bench/suite.h"

namespace mixrig::estimation_bench {
namespace {

constexpr double kMost = 2.0;  // both measures are drawn from 0 to here
constexpr const char* kBound = "#236";
constexpr const char* kNees = "#c33";

__attribute__((format(printf, 2, 3))) void put(std::string& text, const char* format, ...) {
  char line[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  text += line;
}

std::string page(double width, double height, const std::string& body) {
  std::string text;
  put(text,
      "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' "
      "font-family='sans-serif' font-size='11'>\n"
      "<rect width='100%%' height='100%%' fill='white'/>\n",
      width, height);
  return text + body + "</svg>\n";
}

double shown_at(double value) { return std::clamp(value, 0.0, kMost); }

/// Shares of ok, weak and refused as a bar.
void put_verdicts(std::string& text, const Row& row, double x, double y, double width,
                  double height) {
  const double all = std::max(1, row.ok + row.weak + row.refused);
  double at = x;
  const auto bar = [&](int count, const char* fill) {
    const double share = width * count / all;
    put(text, "<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f' fill='%s'/>\n", at, y, share,
        height, fill);
    at += share;
  };
  bar(row.ok, "#4a4");
  bar(row.weak, "#eb4");
  bar(row.refused, "#aaa");
}

void put_case(std::string& text, const Row& r, double left, double unit, double y) {
  put(text, "<text x='%.0f' y='%.0f' text-anchor='end'>%s: %s</text>\n", left - 8, y + 4,
      r.estimator.c_str(), r.name.c_str());
  if (!std::isnan(r.nees)) {
    put(text, "<line x1='%.1f' y1='%.0f' x2='%.1f' y2='%.0f' stroke='#9ab' stroke-width='5'/>\n",
        left + unit * shown_at(r.low), y, left + unit * shown_at(r.high), y);
    put(text, "<circle cx='%.1f' cy='%.0f' r='3.5' fill='%s'/>\n", left + unit * shown_at(r.nees),
        y, kNees);
  }
  if (!std::isnan(r.over_bound))
    put(text, "<path d='M%.1f %.0f l4 4 l-4 4 l-4 -4z' fill='%s'/>\n",
        left + unit * shown_at(r.over_bound), y - 4, kBound);
  put_verdicts(text, r, left + kMost * unit + 12, y - 5, 60, 10);
  put(text, "<text x='%.0f' y='%.0f' text-anchor='end'>%.1f us</text>\n", left + kMost * unit + 135,
      y + 4, r.micros);
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
void put_panel(std::string& text, const Sweep& sweep, double x0, double y0) {
  constexpr double kWidth = 330, kHeight = 150;
  const double first = std::log10(sweep.front().at), last = std::log10(sweep.back().at);
  const auto x = [&](const Row& r) {
    return x0 + kWidth * (std::log10(r.at) - first) / (last - first);
  };
  const auto y = [&](double value) { return y0 + kHeight * (1 - shown_at(value) / kMost); };
  put(text, "<text x='%.0f' y='%.0f' font-weight='bold'>%s</text>\n", x0, y0 - 8,
      sweep.front().estimator.c_str());
  for (const double value : {0.0, 1.0, 2.0}) {
    put(text, "<line x1='%.0f' y1='%.1f' x2='%.0f' y2='%.1f' stroke='#ccc'/>\n", x0, y(value),
        x0 + kWidth, y(value));
    put(text, "<text x='%.0f' y='%.1f' text-anchor='end'>%.0f</text>\n", x0 - 5, y(value) + 4,
        value);
  }
  for (const Row& r : sweep) {
    put(text, "<text x='%.1f' y='%.1f' text-anchor='middle'>%g</text>\n", x(r), y0 + kHeight + 32,
        r.at);
    put_verdicts(text, r, x(r) - 16, y0 + kHeight + 8, 32, 10);
    if (!std::isnan(r.nees))
      put(text, "<circle cx='%.1f' cy='%.1f' r='3.5' fill='%s'/>\n", x(r), y(r.nees), kNees);
    if (!std::isnan(r.over_bound))
      put(text, "<path d='M%.1f %.1f l4 4 l-4 4 l-4 -4z' fill='%s'/>\n", x(r), y(r.over_bound) - 4,
          kBound);
  }
  put(text, "<text x='%.0f' y='%.0f' text-anchor='middle'>%s</text>\n", x0 + kWidth / 2,
      y0 + kHeight + 48, sweep.front().axis.c_str());
}

std::string legend(const std::string& interval) {
  return "blue diamond: error / Cramer-Rao bound; red dot: NEES / degree of freedom" + interval +
         "; bar: ok (green), weak (yellow), refused (grey)";
}

}  // namespace

std::string cases_svg(const Report& report) {
  constexpr double kRow = 16, kLeft = 370, kUnit = 180;
  std::string body = "<text x='20' y='18'>" + legend(" with its 95 % interval") + "</text>\n";
  double y = 40;
  for (const Row& row : report.rows) {
    if (!row.axis.empty()) continue;
    put_case(body, row, kLeft, kUnit, y);
    y += kRow;
  }
  put(body, "<line x1='%.0f' y1='28' x2='%.0f' y2='%.0f' stroke='#999'/>\n", kLeft + kUnit,
      kLeft + kUnit, y);
  return page(kLeft + kMost * kUnit + 155, y + 10, body);
}

std::string sweeps_svg(const Report& report) {
  constexpr double kAcross = 420, kDown = 240;
  std::string body = "<text x='20' y='18'>" + legend("") + "</text>\n";
  const auto sweeps = sweeps_of(report);
  for (std::size_t i = 0; i < sweeps.size(); ++i)
    put_panel(body, sweeps[i], 50 + kAcross * static_cast<double>(i % 2),
              60 + kDown * static_cast<double>(i / 2));
  return page(2 * kAcross + 20, 40 + kDown * static_cast<double>((sweeps.size() + 1) / 2), body);
}

}  // namespace mixrig::estimation_bench
