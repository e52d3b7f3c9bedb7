// SPDX-License-Identifier: Apache-2.0
// A pan-tilt unit emulated byte by byte: the ASCII protocol, moving axes, and faults.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/device/byte_stream.h"

namespace mixrig::fake {

/// Behaves like a PTU-D46. Commands end in space or CR; time comes from the caller, so that the
/// same class serves tests with a manual clock and a program behind a socket. Not thread-safe.
class FlirPtuEmulator {
 public:
  struct Faults {
    /// Share of replies with "!P" or "!T" inserted at a random place.
    double limit_report_share = 0;
    double noise_share = 0;  ///< share of replies with 1 to 8 random bytes before them
    bool silent = false;     ///< reads commands, never answers
    bool stalled = false;    ///< answers, but the axes do not move
    int late_replies = 0;    ///< how many replies are held back until the next command
  };
  explicit FlirPtuEmulator(std::uint64_t seed = 1) : random_(seed) {}

  /// Takes bytes from the host; answers are appended to `output()`.
  void receive(std::span<const std::uint8_t> bytes, HostTime now);
  /// Bytes for the host, in order; the caller erases what it sent.
  std::string& output() { return output_; }

  /// True positions in steps (pan, tilt). A time before the newest one moves nothing.
  std::array<long, 2> position(HostTime now);
  std::uint64_t commands() const { return commands_; }
  std::uint64_t limit_reports() const { return limit_reports_; }
  Faults faults;

 private:
  struct Axis {
    double position = 0, speed = 1000, acceleration = 2000;
    long target = 0, minimum = -3090, maximum = 3090;
    double arcsec = 185.1428;
  };
  void run(std::string_view command, HostTime now);
  void move(HostTime now);
  void on_axis(int index, char what, std::string_view value);
  void on_position(int index, std::string_view value);
  void on_setting(int index, char what, std::string_view value);
  void answer(std::string_view text);
  void answer_number(std::string_view verbose, std::string_view terse);
  std::string with_faults(std::string line);
  double roll() { return std::uniform_real_distribution<>(0, 1)(random_); }

  std::mt19937_64 random_;
  std::array<Axis, 2> axes_{Axis{}, Axis{.minimum = -907, .maximum = 604}};
  HostTime moved_{};
  std::string command_, output_, held_;
  bool echo_ = true, verbose_ = true;
  std::uint64_t commands_ = 0, limit_reports_ = 0;
};

/// The host's end of a cable to the emulator, on a given clock. A read that finds nothing sleeps on
/// that clock for the time-out.
class FlirPtuLine final : public device::ByteStream {
 public:
  FlirPtuLine(FlirPtuEmulator& unit, Clock& clock) : unit_(unit), clock_(clock) {}
  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<void> set_line(const device::LineSettings& settings) override;
  bool unplugged = false;
  int baud = 9600;                ///< baud rate of the host; a byte takes ten bits
  int unit_baud = 0;              ///< baud rate of the unit, which understands no other; 0: any
  std::size_t longest_read = 64;  ///< bytes that one read returns at most

 private:
  Duration time_of(std::size_t bytes) const;
  bool understood() const { return unit_baud == 0 || unit_baud == baud; }

  FlirPtuEmulator& unit_;
  Clock& clock_;
};

}  // namespace mixrig::fake
