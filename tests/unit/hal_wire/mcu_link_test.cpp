// SPDX-License-Identifier: Apache-2.0
// Commands over a line that loses, damages and delays bytes; the real firmware code answers.
#include "hal/wire/trigger/mcu_link.h"

#include <gtest/gtest.h>

#include "hal/fake/emulated_board.h"
#include "tests/support/make_image.h"

namespace mixrig::device {
namespace {

using protocol::Verdict;
using std::chrono::milliseconds;

struct Link : ::testing::Test {
  ManualClock clock;
  fake::EmulatedBoard board;
  fake::BoardStream stream{board, clock};
  McuLink link{stream, clock, "test"};
  void SetUp() override {
    board.flash().load(make_image(2048, 1));
    board.power_cycle(false);
    ASSERT_EQ(board.mode(), fake::BoardMode::kFirmware);
  }
  void say_hello() { ASSERT_TRUE(link.ask(protocol::Hello{protocol::kTableHash})); }
};

TEST_F(Link, cut_line_times_out_with_one_line) {
  stream.line.cut = true;
  const HostTime before = clock.now();
  const auto reply = link.ask(protocol::Status{});
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(reply.error().context,
            "no answer from the trigger controller at test to status (20 tries): check cable and "
            "power, or flash it with BOOT0 held");
  EXPECT_LE(clock.now() - before, milliseconds(2100));
  EXPECT_EQ(link.health().unanswered, 1u);
}

TEST_F(Link, one_percent_of_bytes_damaged_loses_no_command) {
  say_hello();
  stream.line.byte_error_share = 0.01;
  for (int i = 0; i < 300; ++i) {
    protocol::SetChannel set;
    set.channel = static_cast<std::uint8_t>(i % 16);
    set.divider = static_cast<std::uint16_t>(1 + i % 7);
    set.width_slots = static_cast<std::uint16_t>(1 + i % 50);
    set.flags = protocol::kFlagEnable;
    const auto done = link.ask(set);
    ASSERT_TRUE(done) << i << ": " << to_line(done.error());
    const auto got = link.ask(protocol::GetChannel{set.channel});
    ASSERT_TRUE(got);
    EXPECT_EQ(*got, static_cast<const protocol::ChannelConfig&>(set));
  }
  EXPECT_GT(link.health().resent, 50u);
  EXPECT_EQ(link.health().unanswered, 0u);
}

TEST_F(Link, queue_keeps_the_order_of_commands) {
  say_hello();
  stream.line.byte_error_share = 0.02;
  std::vector<int> order;
  const McuLink::RetryPolicy retry{milliseconds(100), 40};
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(link.post(
        protocol::Status{}, [&order, i](const auto&) { order.push_back(i); }, retry));
  }
  for (int i = 0; i < 10'000 && order.size() < 20; ++i) {
    ASSERT_TRUE(link.pump(milliseconds(10)));
  }
  ASSERT_EQ(order.size(), 20u);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST_F(Link, queue_is_bounded) {
  const McuLink::RetryPolicy retry;
  for (int i = 0; i < 64; ++i) ASSERT_TRUE(link.post(protocol::Status{}, {}, retry));
  EXPECT_FALSE(link.post(protocol::Status{}, {}, retry));
}

TEST_F(Link, late_answer_to_an_earlier_try_counts_with_its_own_time) {
  say_hello();
  stream.line.delay_max = milliseconds(150);  // longer than a try
  for (int i = 0; i < 50; ++i) {
    RoundTrip times;
    const auto status = link.ask(protocol::Status{}, &times);
    ASSERT_TRUE(status);
    const double board_ns = static_cast<double>(status->now_us) * 1e3;
    EXPECT_GE(board_ns + 1e3, static_cast<double>(times.sent.time_since_epoch().count()));
    EXPECT_LE(board_ns, static_cast<double>(times.received.time_since_epoch().count()));
  }
  EXPECT_GT(link.health().resent, 0u);
  EXPECT_GT(link.health().stale_replies, 0u);
}

TEST_F(Link, telemetry_gaps_are_counted) {
  say_hello();
  std::uint64_t got = 0;
  link.on_telemetry([&](std::uint8_t, auto) { ++got; });
  ASSERT_TRUE(link.ask(protocol::Subscribe{protocol::kSubscribeTicks}));
  ASSERT_TRUE(link.ask(protocol::Arm{}));
  ASSERT_TRUE(link.ask(protocol::Start{}));
  stream.line.byte_error_share = 0.005;
  const HostTime end = clock.now() + std::chrono::seconds(20);
  while (clock.now() < end) ASSERT_TRUE(link.pump(milliseconds(50)));
  EXPECT_GT(link.health().telemetry_lost, 50u);
  EXPECT_NEAR(static_cast<double>(got + link.health().telemetry_lost), 2000, 5);
}

}  // namespace
}  // namespace mixrig::device
