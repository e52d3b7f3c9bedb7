// SPDX-License-Identifier: Apache-2.0
// Faults of the controller: each is injected and must be counted by its name.
#include <random>

#include <gtest/gtest.h>

#include "board_client.h"

namespace mixrig::sim {
namespace {

using protocol::Fault;
using protocol::Verdict;

struct AppFault : ::testing::Test {
  SimBoard board;
  BoardClient host{board};
  void SetUp() override { ASSERT_EQ(host.say_hello(), Verdict::kOk); }
};

TEST_F(AppFault, tick_interrupt_late_is_counted_and_edges_stay_exact) {
  host.set(0, 1, 0, 10);
  host.run();
  board.take_edges();
  board.advance_by(30'000);
  board.advance_to(board.time_us() + 9'990);
  board.block_interrupts(6'000);  // over the next tick, but less than a whole one
  board.advance_by(100'000);
  const auto status = host.status();
  EXPECT_EQ(status.faults[static_cast<std::size_t>(Fault::kTickLate)], 1);
  EXPECT_EQ(status.faults[static_cast<std::size_t>(Fault::kTickMissed)], 0);
  EXPECT_EQ(status.late_max_ns, 5'990'000u);
  const auto edges = board.take_edges();
  for (std::size_t i = 2; i < edges.size(); ++i) {
    ASSERT_EQ(edges[i].time_us - edges[i - 2].time_us, 10'000u);
  }
}

TEST_F(AppFault, missed_ticks_are_counted_and_phase_is_kept) {
  host.set(0, 4, 0, 10);
  host.run();
  board.advance_by(10'000);
  const std::uint64_t start_us = board.time_us();
  board.advance_by(95'000);
  board.block_interrupts(36'000);  // ticks 10, 11, 12: one interrupt for three
  board.advance_by(36'000);
  board.take_edges();
  board.advance_by(400'000);
  const auto status = host.status();
  EXPECT_EQ(status.faults[static_cast<std::size_t>(Fault::kTickMissed)], 3);
  EXPECT_EQ(status.tick, (board.time_us() - start_us) / 10'000);
  int pulses = 0;
  for (const LineEdge& edge : board.take_edges()) {
    if (edge.high && edge.time_us > start_us + 160'000) {
      EXPECT_EQ((edge.time_us - start_us) % 40'000, 0u);
      ++pulses;
    }
  }
  EXPECT_GE(pulses, 8);
}

TEST_F(AppFault, host_gone_for_an_hour_keeps_running_and_is_reported) {
  host.set(0, 4, 0, 10);
  host.ask(protocol::Subscribe{protocol::kSubscribeTicks});
  host.run();
  board.advance_by(10'000);
  std::uint64_t rising = 0;
  for (int minute = 0; minute < 60; ++minute) {
    board.advance_by(60'000'000);
    for (const LineEdge& edge : board.take_edges()) rising += edge.high;
    board.transmitted();
  }
  EXPECT_EQ(rising, 3600u * 25 + 1);
  const auto status = host.status();
  EXPECT_EQ(status.state, protocol::State::kRunning);
  EXPECT_EQ(status.tick, 360'000u);
  EXPECT_EQ(status.faults[static_cast<std::size_t>(Fault::kHostLost)], 1);
  EXPECT_GE(status.silence_max_s, 3599);
  EXPECT_EQ(status.faults[static_cast<std::size_t>(Fault::kTickMissed)], 0);
}

TEST_F(AppFault, silence_is_counted_once_per_loss) {
  host.run();
  for (int i = 0; i < 3; ++i) {
    board.advance_by(3'000'000);
    host.status();
  }
  EXPECT_EQ(host.faults(Fault::kHostLost), 3);
}

TEST_F(AppFault, telemetry_overrun_is_counted_and_replies_still_come) {
  for (int i = 0; i < 16; ++i) host.set(i, 1, i, 10);
  host.ask(protocol::Subscribe{protocol::kSubscribeTicks | protocol::kSubscribeEdges});
  host.run();
  board.hold_transmitter(true);
  board.advance_by(1'000'000);
  board.hold_transmitter(false);
  EXPECT_GT(host.faults(Fault::kTelemetryLost), 1000);
  EXPECT_EQ(host.faults(Fault::kReplyLost), 0);
  EXPECT_EQ(host.faults(Fault::kTickMissed), 0);
}

TEST_F(AppFault, received_bytes_without_room_are_counted) {
  board.hang_main_loop();
  board.receive(std::vector<std::uint8_t>(300, 0x55));
  board.hang_main_loop(false);
  board.advance_by(1'000);
  EXPECT_GE(host.faults(Fault::kRxOverrun), 300 - 256);
}

TEST_F(AppFault, replies_without_room_are_counted_and_later_ones_are_sent) {
  std::array<std::uint8_t, protocol::kMaxWire> wire;
  const std::size_t n = protocol::encode_frame(protocol::Status::kId, 9, {}, wire);
  board.hold_transmitter(true);
  for (int i = 0; i < 100; ++i) board.receive({wire.data(), n});
  board.hold_transmitter(false);
  board.advance_by(1'000);
  board.transmitted();
  EXPECT_GT(host.faults(Fault::kReplyLost), 50);
}

TEST_F(AppFault, garbage_is_counted_and_commands_still_work) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> noise(64 * 1024);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
  board.receive(noise);
  board.transmitted();
  EXPECT_GT(host.faults(Fault::kFrameBad), 100);
}

TEST_F(AppFault, watchdog_resets_a_hung_main_loop_and_lines_go_safe) {
  host.set(0, 1, 0, 90);
  host.run();
  board.advance_by(25'000);
  ASSERT_EQ(board.driven(), 1);
  board.hang_main_loop();
  board.advance_by(600'000);
  EXPECT_EQ(board.resets(), 1u);
  EXPECT_EQ(board.driven(), 0);
  EXPECT_EQ(host.ask(protocol::Status{}), Verdict::kHelloFirst);
  host.say_hello();
  EXPECT_EQ(host.faults(Fault::kWatchdog), 1);
}

TEST_F(AppFault, watchdog_also_resets_when_ticks_stop) {
  board.block_interrupts(700'000);
  board.advance_by(650'000);
  EXPECT_EQ(board.resets(), 1u);
}

TEST_F(AppFault, reset_during_a_run_is_reported_by_the_next_command) {
  host.set(0, 1, 0, 5);
  host.run();
  board.advance_by(100'000);
  board.reset(protocol::ResetCause::kPower);
  EXPECT_EQ(host.ask(protocol::Start{}), Verdict::kHelloFirst);
  EXPECT_EQ(host.ask(protocol::Status{}), Verdict::kHelloFirst);
  EXPECT_EQ(host.say_hello(), Verdict::kOk);
  EXPECT_EQ(host.status().state, protocol::State::kIdle);
}

TEST(AppVersion, another_message_table_is_refused_but_may_reboot) {
  SimBoard board;
  BoardClient host(board);
  protocol::HelloReply reply;
  EXPECT_EQ(host.ask(protocol::Hello{protocol::kTableHash ^ 1}, &reply), Verdict::kTableMismatch);
  EXPECT_EQ(reply.table_hash, protocol::kTableHash);
  EXPECT_EQ(host.ask(protocol::Start{}), Verdict::kHelloFirst);
  const protocol::Reboot reboot{protocol::RebootTarget::kBootloader, protocol::kRebootKey};
  EXPECT_EQ(host.ask(reboot), Verdict::kOk);
}

TEST(AppImage, damaged_image_never_drives_a_line) {
  port::Identity identity;
  identity.image_bad = true;
  SimBoard board(identity);
  BoardClient host(board);
  protocol::HelloReply reply;
  EXPECT_EQ(host.ask(protocol::Hello{protocol::kTableHash}, &reply), Verdict::kOk);
  EXPECT_EQ(reply.image_ok, 0);
  EXPECT_EQ(host.set(0, 1, 0, 5), Verdict::kImageBad);
  EXPECT_EQ(host.ask(protocol::Arm{}), Verdict::kImageBad);
  EXPECT_EQ(host.faults(Fault::kImageBad), 1);
}

TEST(AppClock, internal_oscillator_is_reported) {
  port::Identity identity;
  identity.clock = protocol::ClockSource::kInternal;
  SimBoard board(identity);
  BoardClient host(board);
  host.say_hello();
  EXPECT_EQ(host.faults(Fault::kClockFallback), 1);
}

}  // namespace
}  // namespace mixrig::sim
