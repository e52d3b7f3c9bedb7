// SPDX-License-Identifier: Apache-2.0
// The unmodified firmware image in QEMU's STM32F405, under an instruction clock (8 ns each).
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

#include "child_process.h"
#include "hal/fake/emulated_board.h"
#include "hal/linux/flash_image.h"
#include "hal/linux/mcu_trigger.h"
#include "hal/linux/posix_byte_stream.h"
#include "hal/linux/stm32_rom.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::device {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kImageDir = MIXRIG_IMAGE_DIR;
constexpr int kLimit_s = 120;  // of the wall clock, for a machine with much else to do

double seconds_of(Duration d) { return std::chrono::duration<double>(d).count(); }

/// One QEMU with its serial line on a socket.
class Qemu {
 public:
  explicit Qemu(const std::string& kernel, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"qemu-system-arm",
                                      "-M",
                                      "netduinoplus2",
                                      "-nographic",
                                      "-monitor",
                                      "none",
                                      "-no-reboot",
                                      "-icount",
                                      "shift=3,sleep=off",
                                      "-kernel",
                                      kernel,
                                      "-serial",
                                      "unix:" + socket() + ",server=on,wait=on"};
    words.insert(words.end(), more.begin(), more.end());
    process_ = std::make_unique<test::ChildProcess>(std::move(words), kLimit_s);
  }
  std::string socket() const { return folder_ / "serial"; }
  std::string file(const std::string& name) const { return folder_ / name; }
  int wait() { return process_->wait(); }

  std::unique_ptr<ByteStream> connect(Clock& clock) {
    for (int i = 0; i < 1000; ++i) {
      auto stream = PosixByteStream::connect_unix(socket());
      if (stream) return *std::move(stream);
      clock.sleep_until(clock.now() + milliseconds(5));  // until it listens
    }
    return nullptr;
  }

 private:
  test::TemporaryFolder folder_;
  std::unique_ptr<test::ChildProcess> process_;
};

struct Board {
  SystemClock clock;
  Qemu qemu;
  std::unique_ptr<McuTrigger> trigger;

  explicit Board(std::vector<std::string> more = {})
      : qemu(kImageDir + "/trigger.elf", std::move(more)) {
    auto stream = qemu.connect(clock);
    if (!stream) return;
    auto opened = McuTrigger::open(std::move(stream), clock, "qemu");
    EXPECT_TRUE(opened) << to_line(opened.error());
    if (opened) trigger = *std::move(opened);
    if (trigger) trigger->link().patience.tries = 64;
  }
  bool set(int index, int divider, double phase_ms, double width_ms, bool low = false) {
    const auto ms = [](double v) { return Duration(static_cast<std::int64_t>(v * 1e6)); };
    return static_cast<bool>(trigger->configure(index, {divider, ms(phase_ms), ms(width_ms), low}));
  }
  std::vector<TriggerTick> ticks(std::size_t count) {
    std::vector<TriggerTick> all;
    std::array<TriggerTick, 64> some;
    const HostTime end = clock.now() + seconds(kLimit_s);
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

TEST(QemuTest, greets_with_a_good_image_and_passes_its_self_test) {
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
  std::nth_element(round_trips_ms.begin(), round_trips_ms.begin() + 10, round_trips_ms.end());
  std::printf("tick interrupt entered at most %" PRId64 " instructions late, ran at most %" PRId64
              " instructions; round trip %.2f ms\n",
              status->late_max.count() / 8, status->cost_max.count() / 8, round_trips_ms[10]);
  EXPECT_LE(status->late_max, std::chrono::microseconds(40));
  EXPECT_LE(status->cost_max, std::chrono::microseconds(80));
  // What depends on how busy this machine is (resent commands, a silent host) is left out.
  for (const TriggerFault& fault : status->faults) {
    const bool of_ticks = fault.name.starts_with("tick_") || fault.name == "telemetry_lost";
    EXPECT_TRUE(!of_ticks || fault.count == 0) << fault.name << ": " << fault.count;
  }
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

/// Runs 60 ticks of four channels; returns when each line changed, in ns after tick 0.
std::vector<std::pair<int, std::int64_t>> traced_run() {
  const test::TemporaryFolder folder;
  const std::string log = folder / "trace";
  {
    Board board(
        {"-trace", "memory_region_ops_write", "-trace", "memory_region_ops_read", "-D", log});
    set_four(board);
    EXPECT_TRUE(board.trigger->start());
    EXPECT_GE(board.ticks(60).size(), 60u);
    EXPECT_TRUE(board.trigger->stop());
  }
  std::vector<std::pair<int, std::int64_t>> changes;
  std::uint32_t lines = 8;  // idle: channel 3 rests high
  std::int64_t start_ns = -1;
  for (const Edge& edge : traced_edges(log)) {
    const std::uint32_t after = (lines & ~(edge.word >> 16)) | (edge.word & 0xFFFF);
    if (start_ns < 0 && ((after ^ lines) & 1u) != 0) start_ns = edge.ns;
    for (int c = 0; c < 4; ++c) {
      if (((after ^ lines) >> c & 1u) != 0) changes.push_back({c, edge.ns - start_ns});
    }
    lines = after;
    if (edge.ns - start_ns > 590'000'000 && start_ns >= 0) break;
  }
  return changes;
}

TEST(QemuTest, every_edge_on_the_pins_lies_in_its_slot_and_runs_agree_bit_for_bit) {
  const auto changes = traced_run();
  ASSERT_GT(changes.size(), 150u);
  const std::int64_t period_us[] = {10'000, 40'000, 40'000, 100'000};
  const std::int64_t phase_us[] = {0, 0, 2'500, 0};
  const std::int64_t width_us[] = {1'000, 2'000, 2'000, 5'000};
  int seen[4] = {};
  std::int64_t worst_ns = 0;
  for (const auto& [c, ns] : changes) {
    const std::int64_t wanted_us =
        seen[c] / 2 * period_us[c] + phase_us[c] + (seen[c] % 2 == 0 ? 0 : width_us[c]);
    ++seen[c];
    worst_ns = std::max(worst_ns, std::abs(ns - wanted_us * 1000));
    ASSERT_LE(std::abs(ns - wanted_us * 1000), 5'000) << "channel " << c;
  }
  std::printf("%zu edges, at most %" PRId64 " ns from their slots (emulated stream)\n",
              changes.size(), worst_ns);
  EXPECT_EQ(traced_run(), changes);
}

TEST(QemuTest, answers_after_64_kib_of_garbage) {
  SystemClock clock;
  Qemu qemu(kImageDir + "/trigger.elf");
  auto stream = qemu.connect(clock);
  ASSERT_TRUE(stream);
  std::mt19937 random(1);
  std::vector<std::uint8_t> garbage(64 * 1024);
  for (auto& byte : garbage) byte = static_cast<std::uint8_t>(random());
  ASSERT_TRUE(stream->write(garbage));
  // The greeting waits behind the garbage, for as long as this machine takes over it.
  McuLink link(*stream, clock, "qemu");
  link.patience = {seconds(1), kLimit_s / 2};
  const auto hello = link.ask(protocol::Hello{protocol::kTableHash});
  ASSERT_TRUE(hello) << to_line(hello.error());
  const auto status = link.ask(protocol::Status{});
  ASSERT_TRUE(status) << to_line(status.error());
  EXPECT_GT(status->faults[static_cast<std::size_t>(protocol::Fault::kFrameBad)], 100u);
}

TEST(QemuTest, host_silent_keeps_running_and_is_reported) {
  Board board;
  ASSERT_NO_FATAL_FAILURE(set_four(board));
  ASSERT_TRUE(board.trigger->start());
  ASSERT_GE(board.ticks(400).size(), 400u);  // four seconds without a word from us
  const auto status = board.trigger->status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, TriggerState::kRunning);
  const auto lost = std::find_if(status->faults.begin(), status->faults.end(),
                                 [](const TriggerFault& f) { return f.name == "host_lost"; });
  EXPECT_EQ(lost->count, 1u);
}

TEST(QemuTest, flash_boot_hello_reboot_to_bootloader_flash_again) {
  const auto image = load_image(kImageDir + "/trigger.bin");
  ASSERT_TRUE(image);
  ManualClock manual;
  fake::EmulatedBoard board;
  fake::BoardStream line(board, manual);
  const FlashProgress quiet = [](const char*, std::size_t, std::size_t) {};
  const auto flash = [&] {
    board.power_cycle(true);
    Stm32Rom rom(line, manual);
    const auto info = rom.connect();
    return info && write_flash(rom, *info, image->bytes, quiet);
  };
  ASSERT_TRUE(flash());
  const test::TemporaryFolder folder;
  const auto bytes = board.flash().bytes();
  const std::string chip = folder.write(
      "flash.bin", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  SystemClock clock;
  Qemu qemu(chip);
  auto stream = qemu.connect(clock);
  ASSERT_TRUE(stream);
  {
    McuLink link(*stream, clock, "qemu");
    const auto hello = link.ask(protocol::Hello{protocol::kTableHash});
    ASSERT_TRUE(hello) << to_line(hello.error());
    EXPECT_EQ(hello->image_ok, 1);
    EXPECT_EQ(hello->image_crc, image->header.crc);
    EXPECT_TRUE(
        link.ask(protocol::Reboot{protocol::RebootTarget::kBootloader, protocol::kRebootKey}));
  }
  EXPECT_EQ(qemu.wait(), 0);  // -no-reboot: a reset ends it
  EXPECT_TRUE(flash());
}

}  // namespace
}  // namespace mixrig::device
