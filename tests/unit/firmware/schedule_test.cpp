// SPDX-License-Identifier: Apache-2.0
// The schedule against the definition of a pulse, slot by slot.
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/trigger_schedule.h"

namespace mixrig::firmware {
namespace {

using protocol::ChannelConfig;
using protocol::kChannels;
using protocol::kSlotsPerTick;

ChannelConfig channel(int index, int divider, int phase, int width, bool low = false) {
  ChannelConfig config;
  config.channel = static_cast<std::uint8_t>(index);
  config.divider = static_cast<std::uint16_t>(divider);
  config.phase_slots = static_cast<std::uint16_t>(phase);
  config.width_slots = static_cast<std::uint16_t>(width);
  config.flags =
      static_cast<std::uint8_t>(protocol::kFlagEnable | (low ? protocol::kFlagActiveLow : 0));
  return config;
}

/// Level by the definition: active during [n * period + phase, n * period + phase + width), n >= 0.
bool level_of(const ChannelConfig& config, long slot) {
  const long period = config.divider * static_cast<long>(kSlotsPerTick);
  const long since = slot - config.phase_slots;
  const bool active = since >= 0 && since % period < config.width_slots;
  return active != config.active_low();
}

ChannelConfig random_channel(int index, std::mt19937& random) {
  const int divider = 1 + static_cast<int>(random() % 25);
  const int period = divider * static_cast<int>(kSlotsPerTick);
  const int phase = static_cast<int>(random() % static_cast<unsigned>(period - 1));
  const int width = 1 + static_cast<int>(random() % static_cast<unsigned>(period - phase - 1));
  return channel(index, divider, phase, width, random() & 1);
}

std::uint32_t apply(std::uint32_t lines, std::uint32_t word) {
  return (lines & ~(word >> 16)) | (word & 0xFFFFu);
}

/// Runs `ticks` ticks from `first` on and compares lines, fired masks and edges to the definition.
void expect_matches(TriggerSchedule& schedule, const std::vector<ChannelConfig>& configs,
                    long first, long ticks) {
  std::array<std::uint32_t, kSlotsPerTick> words;
  TickPlan plan;
  std::uint32_t lines = apply(0, schedule.idle_word());
  for (long tick = first; tick < first + ticks; ++tick) {
    schedule.fill(words, plan);
    int edges = 0;
    std::uint32_t fired = 0;
    for (long s = 0; s < static_cast<long>(kSlotsPerTick); ++s) {
      const long slot = tick * static_cast<long>(kSlotsPerTick) + s;
      const std::uint32_t before = lines;
      lines = apply(lines, words[static_cast<std::size_t>(s)]);
      for (const ChannelConfig& config : configs) {
        const bool high = level_of(config, slot);
        ASSERT_EQ((lines >> config.channel & 1u) != 0, high) << "slot " << slot;
        const bool changed = ((before ^ lines) >> config.channel & 1u) != 0;
        if (changed && tick > first) {
          ++edges;
          if (high != config.active_low()) fired |= 1u << config.channel;
        }
      }
    }
    if (tick > first) {
      ASSERT_EQ(plan.edge_count, edges) << "tick " << tick;
      ASSERT_EQ(plan.fired, fired) << "tick " << tick;
    }
  }
}

TEST(Schedule, matches_the_definition_for_random_channels) {
  std::mt19937 random(3);
  for (int round = 0; round < 60; ++round) {
    TriggerSchedule schedule;
    std::vector<ChannelConfig> configs;
    for (int i = 0; i < static_cast<int>(kChannels); ++i) {
      configs.push_back(random_channel(i, random));
      ASSERT_TRUE(schedule.set(configs.back()));
    }
    schedule.rewind();
    ASSERT_NO_FATAL_FAILURE(expect_matches(schedule, configs, 0, 60));
  }
}

TEST(Schedule, first_tick_has_no_pulse_that_never_began) {
  TriggerSchedule schedule;
  ASSERT_TRUE(schedule.set(channel(0, 1, 40, 59)));
  schedule.rewind();
  std::array<std::uint32_t, kSlotsPerTick> words;
  TickPlan plan;
  schedule.fill(words, plan);
  ASSERT_EQ(plan.edge_count, 2);
  EXPECT_EQ(plan.fired, 1);
  EXPECT_EQ(words[0], 1u << 16);
  EXPECT_EQ(words[40], 1u);
  EXPECT_EQ(words[99], 1u << 16);
}

TEST(Schedule, skipping_is_equivalent_to_filling) {
  std::mt19937 random(4);
  for (int round = 0; round < 40; ++round) {
    TriggerSchedule schedule;
    std::vector<ChannelConfig> configs;
    for (int i = 0; i < 4; ++i) {
      configs.push_back(random_channel(i, random));
      ASSERT_TRUE(schedule.set(configs.back()));
    }
    schedule.rewind();
    const long skipped = 1 + static_cast<long>(random() % 100'000);
    schedule.skip(static_cast<std::uint32_t>(skipped));
    ASSERT_NO_FATAL_FAILURE(expect_matches(schedule, configs, skipped, 30));
  }
}

TEST(Schedule, refuses_pulses_that_it_cannot_produce) {
  EXPECT_TRUE(TriggerSchedule::valid(channel(15, 600, 0, 59'999)));
  EXPECT_FALSE(TriggerSchedule::valid(channel(16, 1, 0, 1)));
  EXPECT_FALSE(TriggerSchedule::valid(channel(0, 0, 0, 1)));
  EXPECT_FALSE(TriggerSchedule::valid(channel(0, 601, 0, 1)));
  EXPECT_FALSE(TriggerSchedule::valid(channel(0, 1, 0, 0)));
  EXPECT_FALSE(TriggerSchedule::valid(channel(0, 1, 0, 100)));  // never falls
  EXPECT_FALSE(TriggerSchedule::valid(channel(0, 1, 60, 40)));  // no pause before the next
  EXPECT_FALSE(TriggerSchedule::valid(channel(0, 1, 65535, 65535)));
  ChannelConfig odd = channel(0, 1, 0, 1);
  odd.flags = 0x80;
  EXPECT_FALSE(TriggerSchedule::valid(odd));
  EXPECT_TRUE(TriggerSchedule::valid(ChannelConfig{}));  // disabled
}

TEST(Schedule, refused_configuration_changes_nothing) {
  TriggerSchedule schedule;
  ASSERT_TRUE(schedule.set(channel(2, 4, 0, 10)));
  EXPECT_FALSE(schedule.set(channel(2, 0, 0, 10)));
  EXPECT_EQ(schedule.get(2), channel(2, 4, 0, 10));
  EXPECT_EQ(schedule.enabled(), 1u << 2);
}

TEST(Schedule, idle_word_is_inactive_for_either_polarity) {
  TriggerSchedule schedule;
  ASSERT_TRUE(schedule.set(channel(0, 4, 0, 10)));
  ASSERT_TRUE(schedule.set(channel(5, 4, 0, 10, true)));
  EXPECT_EQ(schedule.idle_word(), 1u << 16 | 1u << 5);
}

}  // namespace
}  // namespace mixrig::firmware
