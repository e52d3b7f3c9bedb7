// SPDX-License-Identifier: Apache-2.0
// The controller on an emulated board: states, commands, outputs.
#include <string>

#include <gtest/gtest.h>

#include "board_client.h"

namespace mixrig::sim {
namespace {

using protocol::Verdict;

struct App : ::testing::Test {
  SimBoard board;
  BoardClient host{board};
  void SetUp() override { ASSERT_EQ(host.say_hello(), Verdict::kOk); }
};

TEST_F(App, goes_from_idle_to_running_and_back) {
  EXPECT_EQ(host.ask(protocol::Start{}), Verdict::kState);
  EXPECT_EQ(host.set(0, 4, 0, 20), Verdict::kOk);
  EXPECT_EQ(host.ask(protocol::Arm{}), Verdict::kOk);
  EXPECT_EQ(host.status().state, protocol::State::kArmed);
  EXPECT_EQ(host.ask(protocol::Start{}), Verdict::kOk);
  EXPECT_EQ(host.status().state, protocol::State::kRunning);
  EXPECT_EQ(host.set(0, 5, 0, 20), Verdict::kState);
  EXPECT_EQ(host.ask(protocol::Arm{}), Verdict::kState);
  EXPECT_EQ(host.ask(protocol::Stop{}), Verdict::kOk);
  EXPECT_EQ(host.status().state, protocol::State::kIdle);
}

TEST_F(App, repeated_commands_have_no_further_effect) {
  host.set(0, 1, 0, 20);
  host.run();
  board.advance_by(55'000);
  const std::uint32_t tick = host.status().tick;
  EXPECT_EQ(host.ask(protocol::Start{}), Verdict::kOk);
  EXPECT_EQ(host.set(0, 1, 0, 20), Verdict::kOk);  // unchanged
  EXPECT_EQ(host.status().tick, tick);
  EXPECT_EQ(host.ask(protocol::Stop{}), Verdict::kOk);
  EXPECT_EQ(host.ask(protocol::Stop{}), Verdict::kOk);
}

TEST_F(App, bad_requests_get_their_verdicts) {
  EXPECT_EQ(host.set(0, 0, 0, 20), Verdict::kArgument);
  EXPECT_EQ(host.ask(protocol::GetChannel{16}), Verdict::kArgument);
  const std::uint8_t one[] = {1};
  const auto ignore = [](auto) {};
  EXPECT_EQ(host.ask_raw(0x3F, {}, ignore), Verdict::kUnknown);
  for (const std::uint8_t id :
       std::initializer_list<std::uint8_t>{2, 0x12, 0x13, 0x14, 0x30, 0x31, 1}) {
    EXPECT_EQ(host.ask_raw(id, one, ignore), Verdict::kLength) << int{id};
  }
  EXPECT_EQ(host.ask_raw(0x10, one, ignore), Verdict::kLength);
  EXPECT_EQ(host.ask_raw(0x20, {}, ignore), Verdict::kLength);
  EXPECT_EQ(host.ask(protocol::Reboot{protocol::RebootTarget::kBootloader, 0}), Verdict::kArgument);
}

TEST_F(App, channel_reads_back_as_set) {
  host.set(7, 9, 33, 44, true);
  protocol::ChannelConfig got;
  EXPECT_EQ(host.ask(protocol::GetChannel{7}, &got), Verdict::kOk);
  EXPECT_EQ(got.channel, 7);
  EXPECT_EQ(got.divider, 9);
  EXPECT_EQ(got.phase_slots, 33);
  EXPECT_EQ(got.width_slots, 44);
  EXPECT_EQ(got.flags, protocol::kFlagEnable | protocol::kFlagActiveLow);
}

TEST_F(App, lines_stay_inputs_until_armed_and_start_inactive) {
  host.set(0, 1, 10, 20);
  host.set(1, 1, 10, 20, true);
  EXPECT_EQ(board.driven(), 0);
  host.ask(protocol::Arm{});
  EXPECT_EQ(board.driven(), 0b11);
  EXPECT_EQ(board.lines(), 0b10u);
}

TEST_F(App, thousand_ticks_give_exact_edges) {
  host.set(0, 1, 0, 10);
  host.set(1, 4, 25, 20);
  host.set(2, 10, 0, 300, true);
  host.ask(protocol::Subscribe{protocol::kSubscribeTicks});
  host.run();
  board.take_edges();
  board.advance_by(10'000);  // the next tick is tick 0
  const std::uint64_t start_us = board.time_us();
  for (int i = 0; i < 1000; ++i) {
    board.advance_by(10'000);
    host.listen();
  }
  ASSERT_EQ(host.ticks.size(), 1001u);
  for (std::size_t i = 0; i < 1001; ++i) {
    ASSERT_EQ(host.ticks[i].tick, i);
    ASSERT_EQ(host.ticks[i].mcu_us - host.ticks[0].mcu_us, i * 10'000);
    const unsigned fired = 1u | (i % 4 == 0 ? 2u : 0u) | (i % 10 == 0 ? 4u : 0u);
    ASSERT_EQ(host.ticks[i].fired, fired) << i;
  }
  const std::uint64_t period_us[] = {10'000, 40'000, 100'000};
  const std::uint64_t phase_us[] = {0, 2'500, 0};
  const std::uint64_t width_us[] = {1'000, 2'000, 30'000};
  std::uint64_t pulses[3] = {};
  for (const LineEdge& edge : board.take_edges()) {
    if (edge.time_us >= start_us + 10'000'000) continue;
    const auto c = edge.channel;
    const bool begins = edge.high != (c == 2);
    const std::uint64_t expected =
        start_us + pulses[c] * period_us[c] + phase_us[c] + (begins ? 0 : width_us[c]);
    ASSERT_EQ(edge.time_us, expected) << "channel " << int{c};
    if (!begins) ++pulses[c];
  }
  EXPECT_EQ(pulses[0], 1000u);
  EXPECT_EQ(pulses[1], 250u);
  EXPECT_EQ(pulses[2], 100u);
}

TEST_F(App, edge_reports_agree_with_the_lines) {
  host.set(3, 2, 7, 11);
  host.ask(protocol::Subscribe{protocol::kSubscribeEdges});
  host.run();
  board.take_edges();
  board.advance_by(10'000);
  const std::uint64_t start_us = board.time_us();
  for (int i = 0; i < 100; ++i) {
    board.advance_by(10'000);
    host.listen();
  }
  const auto lines = board.take_edges();
  ASSERT_EQ(lines.size(), 100u);
  ASSERT_GE(host.edges.size(), lines.size());  // a tick's edges are reported when it begins
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const protocol::TriggerEdge& said = host.edges[i];
    EXPECT_EQ(start_us + said.tick * 10'000ull + said.slot * 100ull, lines[i].time_us);
    EXPECT_EQ(said.level != 0, lines[i].high);
  }
}

TEST_F(App, stop_makes_lines_inactive_at_once) {
  host.set(0, 1, 0, 90);
  host.run();
  board.advance_by(13'000);
  ASSERT_EQ(board.lines(), 1u);
  host.ask(protocol::Stop{});
  EXPECT_EQ(board.lines(), 0u);
  board.advance_by(50'000);
  EXPECT_EQ(board.lines(), 0u);
}

TEST_F(App, changing_a_channel_disarms) {
  host.set(0, 1, 0, 90);
  host.ask(protocol::Arm{});
  host.set(0, 2, 0, 90);
  EXPECT_EQ(host.status().state, protocol::State::kIdle);
  EXPECT_EQ(host.ask(protocol::Start{}), Verdict::kState);
}

TEST_F(App, restart_begins_at_tick_zero) {
  host.set(0, 3, 0, 5);
  host.run();
  board.advance_by(77'000);
  host.ask(protocol::Stop{});
  host.run();
  EXPECT_EQ(host.status().tick, 0u);
  board.take_edges();
  board.advance_by(10'000);
  ASSERT_EQ(board.take_edges().front().high, true);
}

TEST_F(App, self_test_passes_and_sees_a_stopped_clock_and_a_stuck_line) {
  host.set(0, 1, 0, 5, true);
  host.ask(protocol::Arm{});
  const auto failures = [&] {
    protocol::SelfTestReply reply;
    EXPECT_EQ(host.ask(protocol::SelfTest{}, &reply), Verdict::kOk);
    return reply.failures;
  };
  EXPECT_EQ(failures(), 0u);
  board.stop_clock(true);
  board.advance_by(10);
  EXPECT_EQ(failures(), 1u << static_cast<unsigned>(protocol::SelfTestBit::kTimer));
  board.stop_clock(false);
  board.advance_by(10);
  board.force_lines(0);
  EXPECT_EQ(failures(), 1u << static_cast<unsigned>(protocol::SelfTestBit::kOutputs));
}

TEST_F(App, a_typed_question_mark_gets_a_line_of_text) {
  board.transmitted();
  const std::uint8_t typed[] = {'?', '\r'};
  board.receive(typed);
  const auto bytes = board.transmitted();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()),
            "mixrig-trigger 0.1.0 idle, tick 0, faults 0\r\n");
}

TEST_F(App, a_typed_question_mark_is_answered_after_a_partial_frame) {
  const std::uint8_t half[] = {0x00, 0x09, 0x55, 0x66};
  board.receive(half);
  board.advance_by(2'100'000);
  board.transmitted();
  const std::uint8_t typed[] = {'?', '\r'};
  board.receive(typed);
  EXPECT_FALSE(board.transmitted().empty());
}

TEST_F(App, reboots_to_the_bootloader_but_not_while_running) {
  const protocol::Reboot reboot{protocol::RebootTarget::kBootloader, protocol::kRebootKey};
  host.run();
  EXPECT_EQ(host.ask(reboot), Verdict::kState);
  host.ask(protocol::Stop{});
  EXPECT_EQ(host.ask(reboot), Verdict::kOk);
  EXPECT_TRUE(board.in_bootloader());
  EXPECT_EQ(board.driven(), 0);
}

TEST_F(App, reboots_to_the_firmware_and_reports_the_cause) {
  host.ask(protocol::Reboot{protocol::RebootTarget::kFirmware, protocol::kRebootKey});
  EXPECT_EQ(board.resets(), 1u);
  protocol::HelloReply hello;
  EXPECT_EQ(host.ask(protocol::Hello{protocol::kTableHash}, &hello), Verdict::kOk);
  EXPECT_EQ(hello.reset_cause, protocol::ResetCause::kSoftware);
}

}  // namespace
}  // namespace mixrig::sim
