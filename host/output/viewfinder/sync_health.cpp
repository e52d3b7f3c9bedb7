// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/sync_health.h"

namespace mixrig::viewfinder {
namespace {

double rate_hz(std::uint64_t now, std::uint64_t before, double between_s) {
  return between_s > 0 && now >= before ? static_cast<double>(now - before) / between_s : 0;
}

}  // namespace

void describe(const capture::SourceReport& now, const capture::SourceReport& before,
              double between_s, std::span<TextLine> lines) {
  for (TextLine& line : lines) line.clear();
  if (lines.empty()) return;
  const std::size_t streams = std::min(now.streams.size(), lines.size() - 1);
  for (std::size_t i = 0; i < streams; ++i) {
    const capture::StreamReport& stream = now.streams[i];
    const std::uint64_t was = i < before.streams.size() ? before.streams[i].health.frames : 0;
    lines[i].set("{}: {:.1f} frames per second, {} lost, {} missing", stream.name,
                 rate_hz(stream.health.frames, was, between_s), stream.health.lost,
                 stream.pairing.missing);
  }
  lines[streams].set("frame sets: {:.1f} per second, {} incomplete, {} dropped; {} ticks lost",
                     rate_hz(now.sets, before.sets, between_s), now.incomplete_sets,
                     now.dropped_sets, now.ticks_lost);
}

void describe_fault(const capture::SourceReport& report, TextLine& fault) {
  fault.clear();
  for (const capture::StreamReport& stream : report.streams) {
    const device::DeviceState state = stream.health.state;
    if (state == device::DeviceState::kLost)
      return fault.set("camera '{}' ({}) is lost: check its cable and power", stream.name,
                       stream.uri);
    if (state == device::DeviceState::kFailed)
      return fault.set("camera '{}' ({}) has failed: run mixrig diag", stream.name, stream.uri);
  }
}

}  // namespace mixrig::viewfinder
