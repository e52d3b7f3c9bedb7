// SPDX-License-Identifier: Apache-2.0
// The trigger controller seen from the host: configure, run, read ticks, and every failure of
// these.
#include "hal/wire/trigger/mcu_trigger.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "hal/fake/emulated_board.h"
#include "tests/support/count_allocations.h"
#include "tests/support/make_image.h"

namespace mixrig::device {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Trigger : ::testing::Test {
  ManualClock clock;
  fake::EmulatedBoard board;
  fake::BoardStream* stream = nullptr;
  std::unique_ptr<McuTrigger> trigger;

  Result<std::unique_ptr<McuTrigger>> open() {
    auto owned = std::make_unique<fake::BoardStream>(board, clock);
    stream = owned.get();
    return McuTrigger::open(std::move(owned), clock, "test");
  }
  void SetUp() override {
    board.flash().load(make_image(2048, 1));
    board.power_cycle(false);
    auto opened = open();
    ASSERT_TRUE(opened) << to_line(opened.error());
    trigger = std::move(*opened);
  }
  std::uint64_t fault(const TriggerStatus& status, const std::string& name) {
    const auto found = std::find_if(status.faults.begin(), status.faults.end(),
                                    [&](const TriggerFault& f) { return f.name == name; });
    return found == status.faults.end() ? 999'999 : found->count;
  }
  std::vector<TriggerTick> listen(Duration how_long) {
    std::vector<TriggerTick> all;
    const HostTime end = clock.now() + how_long;
    std::array<TriggerTick, 16> some;
    while (clock.now() < end) {
      const auto n = trigger->read_ticks(some, milliseconds(20));
      EXPECT_TRUE(n);
      all.insert(all.end(), some.begin(), some.begin() + static_cast<long>(n ? *n : 0));
    }
    return all;
  }
};

TEST_F(Trigger, ticks_begin_again_with_a_start_after_655_s) {
  ASSERT_TRUE(trigger->configure(0, {1, milliseconds(0), milliseconds(1)}));
  ASSERT_TRUE(trigger->start());
  const auto before = listen(seconds(655));
  ASSERT_FALSE(before.empty());
  EXPECT_GT(before.back().tick, 65'000U) << "a counter of 16 bits would wrap here";
  ASSERT_TRUE(trigger->stop());
  ASSERT_TRUE(trigger->start());
  const auto after = listen(milliseconds(200));
  ASSERT_FALSE(after.empty());
  EXPECT_LT(after.front().tick, 100U);
}

TEST_F(Trigger, channel_reads_back) {
  ASSERT_TRUE(trigger->configure(5, {4, milliseconds(2), std::chrono::microseconds(700), true}));
  const auto got = trigger->channel(5);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->divider, 4);
  EXPECT_EQ(got->phase, milliseconds(2));
  EXPECT_EQ(got->width, std::chrono::microseconds(700));
  EXPECT_TRUE(got->active_low);
  ASSERT_TRUE(trigger->configure(5, {}));
  EXPECT_EQ(trigger->channel(5)->divider, 0);
}

TEST_F(Trigger, times_continue_past_the_wrap_of_32_bits) {
  clock.advance(std::chrono::minutes(71));
  ASSERT_TRUE(trigger->status());
  ASSERT_TRUE(trigger->start());
  const auto ticks = listen(seconds(60));
  ASSERT_GT(ticks.size(), 5000u);
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    ASSERT_EQ(ticks[i].at - ticks[i - 1].at, milliseconds(10));
  }
  EXPECT_GT(ticks.back().at.time_since_epoch(), std::chrono::microseconds(0x100000000));
}

TEST_F(Trigger, reset_during_a_run_is_reported_counted_and_recovered_from) {
  ASSERT_TRUE(trigger->configure(0, {4, {}, milliseconds(1), false}));
  ASSERT_TRUE(trigger->start());
  listen(seconds(1));
  board.firmware().reset(protocol::ResetCause::kWatchdog);
  const auto stopped = trigger->stop();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().context,
            "trigger controller at test was reset since the last hello: set its channels and "
            "start it again (stop, cause: watchdog)");
  const auto status = trigger->status();
  ASSERT_TRUE(status);
  EXPECT_EQ(fault(*status, "controller_reset"), 1u);
  EXPECT_EQ(fault(*status, "watchdog"), 1u);
  EXPECT_EQ(status->state, TriggerState::kIdle);
  ASSERT_TRUE(trigger->configure(0, {4, {}, milliseconds(1), false}));
  ASSERT_TRUE(trigger->start());
  EXPECT_GT(listen(seconds(1)).size(), 90u);
}

TEST_F(Trigger, status_itself_survives_a_reset) {
  board.firmware().reset(protocol::ResetCause::kPower);
  const auto status = trigger->status();
  ASSERT_TRUE(status) << to_line(status.error());
  EXPECT_EQ(fault(*status, "controller_reset"), 1u);
}

TEST_F(Trigger, every_fault_has_its_own_name_and_a_meaning) {
  const auto status = trigger->status();
  ASSERT_TRUE(status);
  std::vector<std::string> names;
  for (const TriggerFault& f : status->faults) {
    EXPECT_NE(f.name, "unknown");
    EXPECT_GT(f.meaning.size(), 10u) << f.name;
    names.push_back(f.name);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST_F(Trigger, damaged_image_is_refused_at_open) {
  auto image = make_image(2048, 1);
  image[1500] ^= 1;
  board.flash().load(image);
  board.power_cycle(false);
  const auto opened = open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(
      opened.error().context,
      "trigger controller at test (firmware 0.1.0) reports that its firmware image is damaged: "
      "mixrig flash");
}

TEST_F(Trigger, unread_ticks_are_dropped_oldest_first_and_counted) {
  ASSERT_TRUE(trigger->configure(0, {4, {}, milliseconds(1), false}));
  ASSERT_TRUE(trigger->start());
  std::array<TriggerTick, 1> one;
  while (clock.now() < HostTime{} + seconds(15)) {
    ASSERT_TRUE(trigger->link().pump(milliseconds(20)));
  }
  ASSERT_EQ(*trigger->read_ticks(one, {}), 1u);
  EXPECT_GT(one[0].tick, 300u);
  const auto status = trigger->status();
  ASSERT_TRUE(status);
  EXPECT_EQ(fault(*status, "link_reports_lost"), one[0].tick);
}

/// Counts the allocations of the stream behind it, the emulated board.
class Metered final : public ByteStream {
 public:
  Metered(std::unique_ptr<ByteStream> inner, long& allocated)
      : inner_(std::move(inner)), allocated_(allocated) {}
  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override {
    const long before = test::allocations;
    auto count = inner_->read(out, timeout);
    allocated_ += test::allocations - before;
    return count;
  }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return inner_->write(bytes); }
  Result<void> set_line(const LineSettings& settings) override {
    return inner_->set_line(settings);
  }

 private:
  std::unique_ptr<ByteStream> inner_;
  long& allocated_;
};

TEST_F(Trigger, reading_ticks_allocates_nothing) {
  long behind = 0;
  auto opened = McuTrigger::open(
      std::make_unique<Metered>(std::make_unique<fake::BoardStream>(board, clock), behind), clock,
      "test");
  ASSERT_TRUE(opened) << to_line(opened.error());
  ASSERT_TRUE((*opened)->configure(0, {4, {}, milliseconds(1), false}));
  ASSERT_TRUE((*opened)->start());
  std::array<TriggerTick, 16> some;
  std::size_t got = 0;
  const long before = test::allocations - behind;
  while (got < 5000) got += *(*opened)->read_ticks(some, milliseconds(20));
  EXPECT_EQ(test::allocations - behind - before, 0);
}

TEST(McuClockTest, follows_across_wraps_in_both_directions) {
  McuClock clock;
  clock.set(0xFFFFFF00u);
  EXPECT_EQ(clock.extend(0x10), 0x100000010ull);
  EXPECT_EQ(clock.extend(0xFFFFFFF0u), 0xFFFFFFF0ull);  // a report sent before the wrap
  McuClock fresh;
  EXPECT_EQ(fresh.extend(0xF0000000u), 0xF0000000ull);
}

}  // namespace
}  // namespace mixrig::device
