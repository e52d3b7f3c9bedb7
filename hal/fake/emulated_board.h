// SPDX-License-Identifier: Apache-2.0
// A whole trigger board: flash, ROM bootloader, the firmware (the same core as on the real one),
// BOOT0, power, and the serial line to it with its delays and errors.
#pragma once

#include <deque>
#include <memory>
#include <random>

#include "firmware/port/sim/sim_board.h"
#include "hal/base/clock.h"
#include "hal/device/byte_stream.h"
#include "hal/fake/emulated_flash.h"
#include "hal/fake/emulated_rom.h"

namespace mixrig::fake {

/// Program that runs on the board.
enum class BoardMode { kFirmware, kBootloader, kNothing };

/// An emulated trigger board. The caller gives the time. Not thread-safe.
class EmulatedBoard {
 public:
  EmulatedBoard() : rom_(flash_) {}

  /// Switches power off and on. With `boot0` the bootloader starts. Else the firmware starts if
  /// flash holds a vector table, with the result of its own image check; without one nothing runs.
  void power_cycle(bool boot0);
  void receive(std::span<const std::uint8_t> bytes);
  std::vector<std::uint8_t> transmitted();
  /// Runs the board up to `time_us` on its own clock.
  void advance_to(std::uint64_t time_us);
  std::uint64_t next_event_us() const;

  BoardMode mode() const { return mode_; }
  EmulatedFlash& flash() { return flash_; }
  EmulatedRom& rom() { return rom_; }
  /// Precondition: mode() is kFirmware.
  sim::SimBoard& firmware() { return *firmware_; }

 private:
  void boot(protocol::ResetCause cause);
  void follow();

  EmulatedFlash flash_;
  EmulatedRom rom_;
  std::unique_ptr<sim::SimBoard> firmware_;
  BoardMode mode_ = BoardMode::kNothing;
  std::uint64_t time_us_ = 0;
  std::uint64_t boot_us_ = 0;
};

/// The host's end of the line to a board, on a manual clock that read() advances.
class BoardStream final : public device::ByteStream {
 public:
  struct Line {
    double byte_error_share = 0;  ///< share of bytes, either way, that are replaced by another
    Duration delay_max{};         ///< delay of each transfer, either way, uniform from 0 to this
    double drift_ppm = 0;         ///< drift of the board's clock
    bool cut = false;             ///< no byte arrives, either way
  };

  /// `board` and `clock` must outlive it.
  BoardStream(EmulatedBoard& board, ManualClock& clock, std::uint64_t seed = 1)
      : board_(board), clock_(clock), random_(seed) {}

  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<void> set_line(const device::LineSettings& settings) override;

  void reseed(std::uint64_t seed) { random_.seed(seed); }
  Line line;
  device::LineSettings settings;  ///< settings of the last set_line()
  /// Returns the board's clock at host time `host`: the truth for tests of a clock map.
  std::uint64_t board_time_us(HostTime host) const;
  HostTime host_time(double board_us) const;

 private:
  struct Parcel {
    HostTime at{};
    std::vector<std::uint8_t> bytes;
  };
  HostTime arrival(std::deque<Parcel>& queue);
  void damage(std::vector<std::uint8_t>& bytes);
  void run_until(HostTime until);
  void deliver();

  EmulatedBoard& board_;
  ManualClock& clock_;
  std::mt19937_64 random_;
  std::deque<Parcel> to_board_, to_host_;
};

}  // namespace mixrig::fake
