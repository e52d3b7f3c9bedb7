// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/software_trigger.h"

#include <string>

namespace mixrig::device {

Result<void> SoftwareSchedule::configure(int channel, const TriggerChannel& settings) {
  if (channel < 0 || channel >= kSoftwareChannels)
    return Error{ErrorCode::kUsage,
                 "trigger channel must be 0 to " + std::to_string(kSoftwareChannels - 1)};
  const Duration period = settings.divider * kSoftwareTick;
  const bool fits = settings.divider == 0 ||
                    (settings.divider > 0 && settings.phase >= Duration(0) &&
                     settings.width > Duration(0) && settings.phase + settings.width < period);
  if (!fits)
    return Error{ErrorCode::kUsage, "trigger channel " + std::to_string(channel) +
                                        ": phase and width must fit between two pulses"};
  channels_[static_cast<std::size_t>(channel)] = settings;
  return {};
}

void SoftwareSchedule::start(HostTime begin) {
  begin_ = begin;
  tick_ = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) lines_[i] = {begin + channels_[i].phase, true};
}

SoftwareSchedule::Edge SoftwareSchedule::next() {
  Edge edge{.at = begin_ + static_cast<long>(tick_) * kSoftwareTick, .tick = tick_};
  for (int i = 0; i < kSoftwareChannels; ++i) {
    const Line& line = lines_[static_cast<std::size_t>(i)];
    if (channel(i).divider > 0 && line.at < edge.at) edge = {line.at, i, line.active, 0};
  }
  if (edge.channel < 0) {
    ++tick_;
    return edge;
  }
  Line& line = lines_[static_cast<std::size_t>(edge.channel)];
  const TriggerChannel& settings = channel(edge.channel);
  line.at += line.active ? settings.width : settings.divider * kSoftwareTick - settings.width;
  line.active = !line.active;
  return edge;
}

std::uint32_t SoftwareSchedule::fired(std::uint64_t tick) const {
  std::uint32_t mask = 0;
  for (int i = 0; i < kSoftwareChannels; ++i) {
    const TriggerChannel& settings = channel(i);
    if (settings.divider <= 0) continue;
    const auto first = static_cast<std::uint64_t>(settings.phase / kSoftwareTick);
    if (tick >= first && (tick - first) % static_cast<std::uint64_t>(settings.divider) == 0)
      mask |= 1U << i;
  }
  return mask;
}

}  // namespace mixrig::device
