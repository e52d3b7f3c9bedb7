// SPDX-License-Identifier: Apache-2.0
#include "firmware/app/trigger_schedule.h"

namespace mixrig::firmware {

using protocol::ChannelConfig;
using protocol::kChannels;
using protocol::kSlotsPerTick;

namespace {

std::uint32_t period_slots(const ChannelConfig& config) { return config.divider * kSlotsPerTick; }

std::uint32_t level_word(std::uint32_t channel, bool high) {
  return 1u << (high ? channel : channel + 16);
}

}  // namespace

bool TriggerSchedule::valid(const ChannelConfig& config) {
  if (config.channel >= kChannels) return false;
  if ((config.flags & ~(protocol::kFlagEnable | protocol::kFlagActiveLow)) != 0) return false;
  if (!config.enabled()) return true;
  if (config.divider < 1 || config.divider > protocol::kMaxDivider) return false;
  // A pulse that extends into the next period would be cut at the start of a run.
  const std::uint32_t end = std::uint32_t{config.phase_slots} + config.width_slots;
  return config.width_slots >= 1 && end < period_slots(config);
}

bool TriggerSchedule::set(const ChannelConfig& config) {
  if (!valid(config)) return false;
  configs_[config.channel] = config;
  return true;
}

std::uint16_t TriggerSchedule::enabled() const {
  std::uint32_t mask = 0;
  for (std::uint32_t i = 0; i < kChannels; ++i) mask |= configs_[i].enabled() ? 1u << i : 0u;
  return static_cast<std::uint16_t>(mask);
}

void TriggerSchedule::rewind() {
  for (std::uint32_t i = 0; i < kChannels; ++i) {
    const ChannelConfig& config = configs_[i];
    position_[i] = config.phase_slots == 0 ? 0 : period_slots(config) - config.phase_slots;
  }
}

void TriggerSchedule::skip(std::uint32_t ticks) {
  for (std::uint32_t i = 0; i < kChannels; ++i) {
    if (!configs_[i].enabled()) continue;
    const std::uint32_t steps = ticks % configs_[i].divider;
    position_[i] = (position_[i] + steps * kSlotsPerTick) % period_slots(configs_[i]);
  }
}

void TriggerSchedule::fill(Words words, TickPlan& plan) {
  for (std::uint32_t& word : words) word = 0;
  plan.fired = 0;
  plan.edge_count = 0;
  for (std::uint32_t i = 0; i < kChannels; ++i) {
    if (configs_[i].enabled()) fill_channel(i, words, plan);
  }
}

void TriggerSchedule::fill_channel(std::uint32_t channel, Words words, TickPlan& plan) {
  const ChannelConfig& config = configs_[channel];
  const std::uint32_t period = period_slots(config);
  const std::uint32_t width = config.width_slots;
  const std::uint32_t position = position_[channel];
  const bool active_high = !config.active_low();
  words[0] |= level_word(channel, (position < width) == active_high);

  const auto edge = [&](std::uint32_t slot, bool high) {
    words[slot] |= level_word(channel, high);
    plan.edges[plan.edge_count++] = {static_cast<std::uint8_t>(slot),
                                     static_cast<std::uint8_t>(channel), high};
  };
  // A period is at least one tick, so each kind of edge occurs at most once per tick.
  // An end at slot 0 belongs to the pulse that ended with the previous tick.
  const std::uint32_t begin = position == 0 ? 0 : period - position;
  const std::uint32_t end = position <= width ? width - position : period - position + width;
  if (begin < kSlotsPerTick) {
    edge(begin, active_high);
    plan.fired = static_cast<std::uint16_t>(plan.fired | 1u << channel);
  }
  if (end < kSlotsPerTick) edge(end, !active_high);

  const std::uint32_t next = position + kSlotsPerTick;
  position_[channel] = next >= period ? next - period : next;
}

std::uint32_t TriggerSchedule::idle_word() const {
  std::uint32_t word = 0;
  for (std::uint32_t i = 0; i < kChannels; ++i) {
    if (configs_[i].enabled()) word |= level_word(i, configs_[i].active_low());
  }
  return word;
}

}  // namespace mixrig::firmware
