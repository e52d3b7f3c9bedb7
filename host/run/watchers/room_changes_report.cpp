// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/room_changes_report.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::session {
namespace {

/// Millimetres, milliseconds and thousandths are enough.
double in_thousandths(double value) { return std::round(value * 1e3) / 1e3; }

template <typename Three>
std::array<double, 3> three(const Three& v) {
  return {in_thousandths(v[0]), in_thousandths(v[1]), in_thousandths(v[2])};
}

nlohmann::json times_json(const measure::QuantileSketch& times) {
  if (times.count() == 0) return {};
  return {{"p50", in_thousandths(times.quantile(0.5))},
          {"p95", in_thousandths(times.quantile(0.95))},
          {"max", in_thousandths(times.max())}};
}

nlohmann::json to_json(const model::RoomChange& c) {
  using model::ChangeKind;
  nlohmann::json out{{"kind", model::name(c.kind)},
                     {"since_s", in_thousandths(c.since_s)},
                     {"found_s", in_thousandths(c.found_s)},
                     {"seen_s", in_thousandths(c.seen_s)},
                     {"certainty", in_thousandths(c.certainty)},
                     {"over", c.over},
                     {"accepted", c.accepted}};
  const bool lights = c.kind == ChangeKind::kLights, color = c.kind == ChangeKind::kColor;
  if (!lights) out["center_m"] = three(c.center_m), out["size_m"] = three(c.size_m);
  if (c.from_m) out["from_m"] = three(*c.from_m);
  if (lights || color) out["factor"] = three(c.factor);
  if (lights) out["common"] = c.common;
  if (c.kind == ChangeKind::kAppeared || c.kind == ChangeKind::kMoved)
    out["unrest_mm"] = in_thousandths(1e3 * c.unrest_m);
  return out;
}

}  // namespace

nlohmann::json to_json(const RoomChangesReport& report) {
  nlohmann::json out{{"frames", report.watch_ms.count()},
                     {"watch_ms", times_json(report.watch_ms)},
                     {"accepted", report.accepted},
                     {"found", nlohmann::json::array()}};
  if (report.accepted > 0)
    out["learn_ms"] = times_json(report.learn_ms), out["swap_ms"] = times_json(report.swap_ms);
  for (const model::RoomChange& change : report.changes) out["found"].push_back(to_json(change));
  return out;
}

std::string to_lines(const RoomChangesReport& report) {
  std::string out;
  for (const model::RoomChange& c : report.changes)
    out += fmt::format("  room: {}, certain after {:.1f} s{}{}\n", model::text(c),
                       c.found_s - c.since_s, c.over ? ", over again" : "",
                       c.accepted ? ", accepted" : "");
  return out;
}

}  // namespace mixrig::session
