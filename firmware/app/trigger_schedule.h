// SPDX-License-Identifier: Apache-2.0
// Divides the master tick into the channels' pulses: one set/reset word per slot.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/protocol/messages.h"

namespace mixrig::firmware {

/// One change of a line within a tick.
struct SlotEdge {
  std::uint8_t slot = 0;
  std::uint8_t channel = 0;
  std::uint8_t level = 0;
};

/// Plan of one tick, besides its set/reset words.
struct TickPlan {
  std::uint16_t fired = 0;  ///< channels whose pulse begins
  std::uint8_t edge_count = 0;
  std::array<SlotEdge, 2 * protocol::kChannels> edges{};
};

class TriggerSchedule {
 public:
  using Words = std::span<std::uint32_t, protocol::kSlotsPerTick>;

  /// Whether `config` keeps the rules stated at protocol::ChannelConfig; a disabled channel is
  /// always valid.
  static bool valid(const protocol::ChannelConfig& config);
  /// Sets a channel; returns false and changes nothing if `config` is not valid.
  bool set(const protocol::ChannelConfig& config);
  /// `channel` < kChannels.
  protocol::ChannelConfig get(std::uint32_t channel) const { return configs_[channel]; }
  std::uint16_t enabled() const;

  /// Restarts the schedule at tick 0.
  void rewind();
  /// Skips `ticks` ticks.
  void skip(std::uint32_t ticks);
  /// Writes the next tick. Slot 0 sets every enabled line, later slots hold only changes.
  void fill(Words words, TickPlan& plan);
  /// Returns the word that makes every enabled line inactive.
  std::uint32_t idle_word() const;

 private:
  void fill_channel(std::uint32_t channel, Words words, TickPlan& plan);

  std::array<protocol::ChannelConfig, protocol::kChannels> configs_{};
  std::array<std::uint32_t, protocol::kChannels> position_{};  ///< slots since the pulse began
};

}  // namespace mixrig::firmware
