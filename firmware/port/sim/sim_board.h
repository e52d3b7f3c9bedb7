// SPDX-License-Identifier: Apache-2.0
// The firmware on an emulated board in this process: time is injected, outputs are recorded.
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

/// Implements firmware/port/port.h for one App. The slot stream runs apart from the interrupts,
/// as the hardware's does. Several boards may live in one thread; one board is not thread-safe.
class SimBoard {
 public:
  explicit SimBoard(port::Identity identity = {});

  /// Bytes arrive at the receiver now.
  void receive(std::span<const std::uint8_t> bytes);
  /// Takes what the transmitter has sent.
  std::vector<std::uint8_t> transmitted();
  /// Lets the transmitter send nothing until told otherwise: the ring behind it fills up.
  void hold_transmitter(bool hold) { hold_transmitter_ = hold; }

  /// Runs slots, interrupts and main loop up to `time_us` since the first power-up.
  void advance_to(std::uint64_t time_us);
  void advance_by(std::uint64_t step_us) { advance_to(time_us_ + step_us); }
  std::uint64_t time_us() const { return time_us_; }
  /// When something will happen without input, for a process that sleeps in between.
  std::uint64_t next_event_us() const;

  /// Keeps interrupts from running for so long, as other code with interrupts masked would.
  void block_interrupts(std::uint64_t duration_us) { blocked_until_us_ = time_us_ + duration_us; }
  /// The main loop hangs until it is let go or the watchdog bites.
  void hang_main_loop(bool hang = true) { hung_ = hang; }
  /// The clock that the firmware reads stands still. Else a long row of readings sees it move on.
  void stop_clock(bool stop) { clock_stopped_ = stop; }
  void reset(protocol::ResetCause cause);

  std::uint32_t lines() const { return lines_; }    ///< level of every line that is driven
  std::uint16_t driven() const { return driven_; }  ///< mask of lines that are outputs
  std::vector<LineEdge> take_edges();
  /// Something outside pulls the lines to these levels until they are next written.
  void force_lines(std::uint32_t levels) { lines_ = levels; }
  std::uint32_t resets() const { return resets_; }
  /// Set once the firmware has handed over to the ROM; reset() brings the firmware back.
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
