// SPDX-License-Identifier: Apache-2.0
// The firmware on an emulated board in this process: the caller gives the time, outputs are
// recorded.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "firmware/app/app.h"
#include "firmware/port/port.h"

namespace mixrig::sim {

/// A change of a line as seen from outside, at the controller's time.
struct LineEdge {
  std::uint64_t time_us = 0;
  std::uint8_t channel = 0;
  bool high = false;
  bool operator==(const LineEdge&) const = default;
};

/// Implements firmware/port/port.h for one App. As in hardware, the slot stream runs independently
/// of the interrupts. A thread may have several boards; one board is not thread-safe.
class SimBoard {
 public:
  explicit SimBoard(port::Identity identity = {});

  /// Bytes arrive at the receiver now.
  void receive(std::span<const std::uint8_t> bytes);
  /// Returns and removes the bytes that the transmitter has sent.
  std::vector<std::uint8_t> transmitted();
  /// While held, the transmitter sends nothing, so that its ring fills up.
  void hold_transmitter(bool hold) { hold_transmitter_ = hold; }

  /// Runs slots, interrupts and main loop up to `time_us` since the first power-up.
  void advance_to(std::uint64_t time_us);
  void advance_by(std::uint64_t step_us) { advance_to(time_us_ + step_us); }
  std::uint64_t time_us() const { return time_us_; }
  /// Time of the next event without input, for a process that sleeps until then.
  std::uint64_t next_event_us() const;

  /// Blocks interrupts for this time, as code with masked interrupts would.
  void block_interrupts(std::uint64_t duration_us) { blocked_until_us_ = time_us_ + duration_us; }
  /// The main loop hangs until hang_main_loop(false) or the watchdog's reset.
  void hang_main_loop(bool hang = true) { hung_ = hang; }
  /// Stops the clock that the firmware reads. Otherwise it advances during a long loop of readings.
  void stop_clock(bool stop) { clock_stopped_ = stop; }
  void reset(protocol::ResetCause cause);

  std::uint32_t lines() const { return lines_; }    ///< level of every line that is driven
  std::uint16_t driven() const { return driven_; }  ///< mask of lines that are outputs
  std::vector<LineEdge> take_edges();
  /// An external driver forces the lines to these levels until they are next written.
  void force_lines(std::uint32_t levels) { lines_ = levels; }
  std::uint32_t resets() const { return resets_; }
  /// Whether the firmware has started the ROM bootloader; reset() starts the firmware again.
  bool in_bootloader() const { return in_bootloader_; }

 private:
  friend struct PortAccess;

  void run_slot();
  void run_interrupt();
  void run_main_loop();
  void set_lines(std::uint32_t word);
  std::uint64_t read_clock_us();

  port::Identity identity_;
  std::unique_ptr<firmware::App> app_;
  std::vector<std::uint8_t> transmitted_;
  std::vector<LineEdge> edges_;

  std::uint64_t time_us_ = 0;
  std::uint64_t reset_at_us_ = 0;
  std::uint64_t next_slot_us_ = 0;
  std::uint64_t next_tick_us_ = 0;
  std::uint64_t last_tick_us_ = 0;
  std::uint64_t blocked_until_us_ = 0;
  std::uint64_t fed_at_us_ = 0;
  std::uint64_t read_at_us_ = 0;
  std::uint32_t readings_ = 0;
  bool clock_stopped_ = false;
  bool interrupt_pending_ = false;

  const std::uint32_t* words_ = nullptr;
  bool streaming_ = false;
  std::uint32_t position_ = 0;
  std::uint32_t lines_ = 0;
  std::uint16_t driven_ = 0;

  std::uint32_t resets_ = 0;
  bool hung_ = false;
  bool hold_transmitter_ = false;
  bool in_bootloader_ = false;
  std::optional<protocol::RebootTarget> reboot_;
};

}  // namespace mixrig::sim
