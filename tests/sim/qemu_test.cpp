// SPDX-License-Identifier: Apache-2.0
// The unmodified firmware image in QEMU's STM32F405.
#include "qemu.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/order_statistics.h"
#include "hal/wire/flash/firmware_image.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/hal_device/trigger_contract.h"

namespace mixrig::device {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kImageDir = MIXRIG_IMAGE_DIR;

double seconds_of(Duration d) { return std::chrono::duration<double>(d).count(); }

struct Board {
  SystemClock clock;
  test::Qemu qemu;
  std::unique_ptr<McuTrigger> trigger;

  explicit Board(std::vector<std::string> more = {})
      : qemu(kImageDir + "/trigger.elf", std::move(more)) {
    auto stream = qemu.connect(clock);
    if (!stream) return;
    auto opened = McuTrigger::open(std::move(stream), clock, "qemu", {milliseconds(100), 64});
    EXPECT_TRUE(opened) << to_line(opened.error());
    if (opened) trigger = *std::move(opened);
    if (trigger) trigger->link().retry.tries = 64;
  }
  bool set(int index, int divider, double phase_ms, double width_ms, bool low = false) {
    const auto ms = [](double v) { return Duration(static_cast<std::int64_t>(v * 1e6)); };
    return static_cast<bool>(trigger->configure(index, {divider, ms(phase_ms), ms(width_ms), low}));
  }
  std::vector<TriggerTick> ticks(std::size_t count) {
    std::vector<TriggerTick> all;
    std::array<TriggerTick, 64> some;
    const HostTime end = clock.now() + seconds(test::kQemuLimit_s);
    while (all.size() < count && clock.now() < end) {
      const auto n = trigger->read_ticks(some, milliseconds(100));
      if (!n) break;
      all.insert(all.end(), some.begin(), some.begin() + static_cast<long>(*n));
    }
    return all;
  }
};

void set_four(Board& board) {
  ASSERT_TRUE(board.trigger);
  ASSERT_TRUE(board.set(0, 1, 0, 1));
  ASSERT_TRUE(board.set(1, 4, 0, 2));
  ASSERT_TRUE(board.set(2, 4, 2.5, 2));
  ASSERT_TRUE(board.set(3, 10, 0, 5, true));
}

TEST(QemuTest, answers_hello_with_a_good_image_and_passes_its_self_test) {
  Board board;
  ASSERT_TRUE(board.trigger);
  const auto image = load_image(kImageDir + "/trigger.bin");
  ASSERT_TRUE(image) << to_line(image.error());
  EXPECT_LE(image->bytes.size(), 12u * 1024);
  EXPECT_EQ(board.trigger->info().image_crc, image->header.crc);
  EXPECT_EQ(board.trigger->info().clock, "emulated");
  const auto failed = board.trigger->self_test();
  ASSERT_TRUE(failed);
  EXPECT_TRUE(failed->empty());
}

TEST(QemuTest, thousand_ticks_are_exactly_10_ms_apart_with_commands_in_flight) {
  Board board;
  ASSERT_NO_FATAL_FAILURE(set_four(board));
  ASSERT_TRUE(board.trigger->start());
  std::vector<TriggerTick> all;
  std::vector<double> round_trips_ms;
  while (all.size() < 1000) {
    const auto some = board.ticks(20);
    ASSERT_FALSE(some.empty());
    all.insert(all.end(), some.begin(), some.end());
    const auto status = board.trigger->status();
    ASSERT_TRUE(status);
    round_trips_ms.push_back(seconds_of(status->answered - status->asked) * 1e3);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_EQ(all[i].tick, i);
    ASSERT_EQ(all[i].at - all[0].at, milliseconds(10) * static_cast<long>(i));
    const unsigned wanted = 1u | (i % 4 == 0 ? 6u : 0u) | (i % 10 == 0 ? 8u : 0u);
    ASSERT_EQ(all[i].channels, wanted) << i;
  }
  const auto status = board.trigger->status();
  ASSERT_TRUE(status);
  std::printf("tick interrupt entered at most %" PRId64 " instructions late, ran at most %" PRId64
              " instructions; status over a socket: median of %zu round trips %.2f ms\n",
              status->late_max.count() / 8, status->cost_max.count() / 8, round_trips_ms.size(),
              upper_median_in_place(std::span(round_trips_ms)));
  EXPECT_LE(status->late_max, std::chrono::microseconds(40));
  EXPECT_LE(status->cost_max, std::chrono::microseconds(80));
  // Faults that depend on the load of this machine (resent commands, host_lost) are not checked.
  for (const TriggerFault& fault : status->faults) {
    const bool of_ticks = fault.name.starts_with("tick_") || fault.name == "telemetry_lost";
    EXPECT_TRUE(!of_ticks || fault.count == 0) << fault.name << ": " << fault.count;
  }
}

TEST(QemuTest, busiest_tick_of_all_sixteen_lines_stays_below_its_bound) {
  Board board;
  ASSERT_TRUE(board.trigger);
  for (int i = 0; i < 16; ++i) ASSERT_TRUE(board.set(i, 1, 0.5 * i, 0.3, i % 2 == 1));
  const auto all = protocol::kSubscribeTicks | protocol::kSubscribeEdges;
  ASSERT_TRUE(board.trigger->link().ask(protocol::Subscribe{all}));
  ASSERT_TRUE(board.trigger->start());
  ASSERT_GE(board.ticks(100).size(), 100u);
  const auto status = board.trigger->status();
  ASSERT_TRUE(status);
  std::printf("32 edges in every tick, all reported: tick interrupt entered at most %" PRId64
              " instructions late, ran at most %" PRId64 " instructions\n",
              status->late_max.count() / 8, status->cost_max.count() / 8);
  EXPECT_LE(status->late_max, std::chrono::microseconds(40));
  EXPECT_LE(status->cost_max, std::chrono::microseconds(80));
}

struct Edge {
  std::int64_t ns;
  std::uint32_t word;
};

/// Writes to the set/reset register of port C, each with the emulated clock read just before it.
std::vector<Edge> traced_edges(const std::string& path) {
  std::vector<Edge> edges;
  std::ifstream in(path);
  std::int64_t ns = 0;
  std::uint32_t last = 0;
  for (std::string line; std::getline(in, line);) {
    std::uint64_t address = 0, value = 0;
    const std::size_t at = line.find("addr 0x");
    if (at == std::string::npos ||
        std::sscanf(line.c_str() + at, "addr 0x%" SCNx64 " value 0x%" SCNx64, &address, &value) !=
            2)
      continue;
    const bool read = line.find("ops_read") != std::string::npos;
    if (read && address == 0x40000424) {
      ns += static_cast<std::int32_t>(static_cast<std::uint32_t>(value) - last);
      last = static_cast<std::uint32_t>(value);
    } else if (!read && address == 0x40020818) {
      edges.push_back({ns, static_cast<std::uint32_t>(value)});
    }
  }
  return edges;
}

struct Change {
  int channel;
  std::int64_t ns;
};

/// Runs 60 ticks of four channels. Returns when each line changed in the first 58, in ns on the
/// time grid on which tick 1 begins at 10 ms. Tick 0 may be off by about 100 ns: the command that
/// started it still interrupts the processor, which does the work of the DMA in QEMU.
std::vector<Change> traced_run() {
  const test::TemporaryFolder folder;
  const std::string log = folder / "trace";
  {
    Board board(
        {"-trace", "memory_region_ops_write", "-trace", "memory_region_ops_read", "-D", log});
    set_four(board);
    // A command sent twice would interrupt later ticks, so it is resent only if it was lost.
    board.trigger->link().retry = {seconds(test::kQemuLimit_s / 4), 2};
    EXPECT_TRUE(board.trigger->start());
    EXPECT_GE(board.ticks(60).size(), 60u);
    EXPECT_TRUE(board.trigger->stop());
  }
  std::vector<Change> changes;
  std::uint32_t lines = 8;  // idle: channel 3 is high
  std::int64_t grid_ns = 0;
  int rises = 0;  // rising edges of channel 0, which rises with every tick
  for (const Edge& edge : traced_edges(log)) {
    const std::uint32_t after = (lines & ~(edge.word >> 16)) | (edge.word & 0xFFFF);
    const std::uint32_t changed = after ^ lines;
    if ((changed & after & 1u) != 0 && ++rises == 2) grid_ns = edge.ns - 10'000'000;
    if (rises == 59) break;
    lines = after;
    if (rises == 0) continue;  // lines are set up, some again where a command was resent
    for (int c = 0; c < 4; ++c) {
      if ((changed >> c & 1u) != 0) changes.push_back({c, edge.ns});
    }
  }
  for (Change& change : changes) change.ns -= grid_ns;
  return changes;
}

TEST(QemuTest, every_edge_on_the_pins_lies_in_its_slot_and_runs_agree) {
  const std::int64_t period_us[] = {10'000, 40'000, 40'000, 100'000};
  const std::int64_t phase_us[] = {0, 0, 2'500, 0};
  const std::int64_t width_us[] = {1'000, 2'000, 2'000, 5'000};
  for (int run = 0; run < 2; ++run) {
    const auto changes = traced_run();
    // Ticks 0 to 57: 58 pulses of line 0, 15 each of lines 1 and 2 (40, 42.5 ms), 6 of line 3.
    ASSERT_EQ(changes.size(), 2u * (58 + 15 + 15 + 6));
    int seen[4] = {};
    std::int64_t worst_ns = 0;
    for (const auto& [c, ns] : changes) {
      const std::int64_t wanted_us =
          seen[c] / 2 * period_us[c] + phase_us[c] + (seen[c] % 2 == 0 ? 0 : width_us[c]);
      ++seen[c];
      worst_ns = std::max(worst_ns, std::abs(ns - wanted_us * 1000));
      ASSERT_LE(std::abs(ns - wanted_us * 1000), 5'000) << "channel " << c << ", run " << run;
    }
    std::printf("%zu edges, at most %" PRId64 " ns from their slots (emulated stream)\n",
                changes.size(), worst_ns);
  }
}

TEST(QemuTest, answers_after_64_kib_of_random_bytes) {
  SystemClock clock;
  test::Qemu qemu(kImageDir + "/trigger.elf", {}, test::IdleTime::kPasses);
  auto stream = qemu.connect(clock);
  ASSERT_TRUE(stream);
  std::mt19937 random(1);
  std::vector<std::uint8_t> noise(64 * 1024);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
  ASSERT_TRUE(stream->write(noise));
  // The firmware reads Hello after the random bytes: the timeout covers the time that this machine
  // takes to emulate them.
  McuLink link(*stream, clock, "qemu");
  link.retry = {seconds(1), test::kQemuLimit_s / 2};
  const auto hello = link.ask(protocol::Hello{protocol::kTableHash});
  ASSERT_TRUE(hello) << to_line(hello.error());
  const auto status = link.ask(protocol::Status{});
  ASSERT_TRUE(status) << to_line(status.error());
  EXPECT_GT(status->faults[static_cast<std::size_t>(protocol::Fault::kFrameBad)], 100u);
}

TEST(QemuTest, keeps_running_without_the_host_and_reports_it) {
  Board board;
  ASSERT_NO_FATAL_FAILURE(set_four(board));
  ASSERT_TRUE(board.trigger->start());
  ASSERT_GE(board.ticks(400).size(), 400u);  // four seconds without a command
  const auto status = board.trigger->status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, TriggerState::kRunning);
  const auto lost = std::find_if(status->faults.begin(), status->faults.end(),
                                 [](const TriggerFault& f) { return f.name == "host_lost"; });
  EXPECT_EQ(lost->count, 1u);
}

TEST(QemuTest, is_not_reset_while_triggers_run_and_is_when_they_stopped) {
  Board board;
  ASSERT_NO_FATAL_FAILURE(set_four(board));
  const protocol::Reboot reboot{protocol::RebootTarget::kBootloader, protocol::kRebootKey};
  ASSERT_TRUE(board.trigger->start());
  protocol::Verdict verdict = protocol::Verdict::kOk;
  ASSERT_TRUE(board.trigger->link().ask(reboot, nullptr, &verdict));
  EXPECT_EQ(verdict, protocol::Verdict::kState);
  ASSERT_TRUE(board.trigger->stop());
  ASSERT_TRUE(board.trigger->link().ask(reboot));
  EXPECT_EQ(board.qemu.wait(), 0);  // -no-reboot: a reset ends it
}

test::TriggerUnderTest make_qemu() {
  auto board = std::make_shared<Board>();
  auto trigger = std::move(board->trigger);
  return {board, std::move(trigger)};
}

}  // namespace
}  // namespace mixrig::device

namespace mixrig::test {
INSTANTIATE_TEST_SUITE_P(Qemu, TriggerContract,
                         ::testing::Values(TriggerMaker{"stm32f405", device::make_qemu}),
                         [](const auto& maker) { return maker.param.name; });
}  // namespace mixrig::test
