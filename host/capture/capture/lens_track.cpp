// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/lens_track.h"

#include <algorithm>

namespace mixrig::capture {
namespace {

/// Whether two times lie further apart than `gap`. It compares halves, since the difference of the
/// times may overflow.
bool apart(HostTime before, HostTime after, Duration gap) {
  return after.time_since_epoch() / 2 - before.time_since_epoch() / 2 > gap / 2;
}

}  // namespace

std::optional<geometry::LensEncoders> lens_at(std::span<const LensSample> samples, HostTime time) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), time,
                                      [](const LensSample& s, HostTime t) { return s.time < t; });
  const auto near = [&](const LensSample& s) {
    const bool there = !apart(std::min(s.time, time), std::max(s.time, time), kMostLensGap / 2);
    return there ? std::optional(s.at) : std::nullopt;
  };
  if (samples.empty()) return std::nullopt;
  if (after == samples.end()) return near(samples.back());
  if (after->time == time || after == samples.begin()) return near(*after);
  const LensSample& a = *std::prev(after);
  if (apart(a.time, after->time, kMostLensGap)) return std::nullopt;
  const double t = seconds(time - a.time) / seconds(after->time - a.time);
  return geometry::LensEncoders{a.at.zoom + t * (after->at.zoom - a.at.zoom),
                                a.at.focus + t * (after->at.focus - a.at.focus)};
}

}  // namespace mixrig::capture
