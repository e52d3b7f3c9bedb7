// SPDX-License-Identifier: Apache-2.0
// The pan-tilt driver and the emulated unit on the two ends of a pseudo-terminal.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include "hal/fake/flir_ptu_emulator.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/wire/pan_tilt/flir_ptu.h"
#include "tests/support/threaded_clock.h"

namespace mixrig::device {
namespace {

/// The unit at the master end. With every chunk of bytes its clock advances by ten seconds, so
/// that its axes have always arrived.
class Unit {
 public:
  Unit() : master_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0) return;
    slave_ = ::ptsname(master_);
    emulator_.faults.limit_report_share = 0.2;
    thread_ = std::thread([this] { work(); });
  }
  ~Unit() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (master_ >= 0) ::close(master_);
  }
  const std::string& slave() const { return slave_; }
  std::uint64_t commands() const { return commands_; }
  /// Bytes that it answered, and of its answers.
  std::uint64_t heard() const { return heard_; }
  std::uint64_t said() const { return said_; }
  std::uint64_t limit_reports() const { return limit_reports_; }

 private:
  void work() {
    std::array<std::uint8_t, 256> bytes;
    ManualClock clock;
    while (!stop_) {
      pollfd poll{master_, POLLIN, 0};
      if (::poll(&poll, 1, 50) <= 0) continue;
      const ssize_t count = ::read(master_, bytes.data(), bytes.size());
      if (count <= 0) continue;  // the other end is not open
      clock.advance(std::chrono::seconds(10));
      emulator_.receive({bytes.data(), static_cast<std::size_t>(count)}, clock.now());
      std::string& out = emulator_.output();
      const ssize_t written = out.empty() ? 0 : ::write(master_, out.data(), out.size());
      if (written > 0) out.erase(0, static_cast<std::size_t>(written));
      commands_ = emulator_.commands();
      limit_reports_ = emulator_.limit_reports();
      said_ += static_cast<std::uint64_t>(std::max<ssize_t>(written, 0));
      heard_ += static_cast<std::uint64_t>(count);
    }
  }
  int master_ = -1;
  std::string slave_;
  fake::FlirPtuEmulator emulator_{11};
  std::atomic<bool> stop_ = false;
  std::atomic<std::uint64_t> commands_ = 0, limit_reports_ = 0, heard_ = 0, said_ = 0;
  std::thread thread_;
};

/// The host's end of the pseudo-terminal. Silence takes no real time: when the unit has answered
/// all that was written and all its answers were read, nothing can come, and the clock advances by
/// what a reader would wait.
class QuietLine final : public ByteStream {
 public:
  QuietLine(std::unique_ptr<ByteStream> stream, const Unit& unit, test::ThreadedClock& clock)
      : stream_(std::move(stream)), unit_(unit), clock_(clock) {}
  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override {
    while (unit_.heard() < written_ || read_ < unit_.said()) {
      MIXRIG_ASSIGN(const std::size_t count, stream_->read(out, std::chrono::milliseconds(1)));
      read_ += count;
      if (count > 0) return count;
    }
    clock_.advance(timeout);
    return std::size_t{0};
  }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    written_ += bytes.size();
    return stream_->write(bytes);
  }

 private:
  std::unique_ptr<ByteStream> stream_;
  const Unit& unit_;
  test::ThreadedClock& clock_;
  std::uint64_t written_ = 0, read_ = 0;
};

TEST(FlirPtuOnAPty, TenThousandCommandsAreAnsweredCorrectlyWithLimitReportsInsideReplies) {
  Unit unit;
  if (unit.slave().empty()) GTEST_SKIP() << "no pseudo-terminal is available here";
  test::ThreadedClock clock;
  auto stream = open_byte_stream(unit.slave());
  ASSERT_TRUE(stream) << to_line(stream.error());
  auto opened = FlirPtu::open(std::make_unique<QuietLine>(*std::move(stream), unit, clock), clock,
                              "flir-ptu:" + unit.slave());
  ASSERT_TRUE(opened) << to_line(opened.error());
  FlirPtu& head = **opened;
  const double step_rad = head.info().resolution.pan_rad;
  std::mt19937_64 random(3);
  std::uniform_int_distribution<long> pan(-3090, 3090), tilt(-907, 604);
  for (int samples = 0; unit.commands() < 10000; ++samples) {
    const long pan_steps = pan(random), tilt_steps = tilt(random);
    ASSERT_TRUE(head.move_to(
        {static_cast<double>(pan_steps) * step_rad, static_cast<double>(tilt_steps) * step_rad}));
    const auto sample = head.sample();
    ASSERT_TRUE(sample) << to_line(sample.error());
    ASSERT_EQ(std::lround(sample->angles.pan_rad / step_rad), pan_steps) << samples;
    ASSERT_EQ(std::lround(sample->angles.tilt_rad / step_rad), tilt_steps) << samples;
  }
  EXPECT_GT(unit.limit_reports(), 1600U);
  EXPECT_EQ(head.health().noise_bytes, 0U);
}

}  // namespace
}  // namespace mixrig::device
