// SPDX-License-Identifier: Apache-2.0
// Functions that the firmware requires of its hardware, one implementation linked per port.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/protocol/messages.h"

namespace mixrig::port {

/// Facts about the board, read once at start. All zero by default, like all of the firmware's
/// state, so that none of it needs initial values in the image.
struct Identity {
  protocol::ResetCause reset_cause = protocol::ResetCause::kUnknown;
  protocol::ClockSource clock = protocol::ClockSource::kEmulated;
  std::uint32_t image_crc = 0;
  bool image_bad = false;
  std::array<std::uint8_t, 12> uid{};
};
Identity identity();

/// Microseconds since reset, never wraps. Any context.
std::uint64_t now_us();

/// Words for a set/reset register: bit n sets line n, bit n+16 resets it, 0 changes nothing.
/// Drives the lines named in `idle_word` to the level it gives and stops the slot stream.
void outputs_idle(std::uint32_t idle_word);
/// From the next master tick on, outputs two_ticks[0 .. 2 * kSlotsPerTick) repeatedly, one word per
/// slot. The half that is not being output may be rewritten.
void outputs_start(const std::uint32_t* two_ticks);
/// Whether the stream has begun: true from the tick after outputs_start.
bool outputs_running();
/// Levels read back at the pins, or `expected` where the port cannot read them.
std::uint16_t outputs_read(std::uint16_t expected);

/// Starts the transmitter: App::next_tx_byte has bytes.
void uart_kick();
/// Restarts the independent watchdog (about 500 ms).
void watchdog_feed();
/// Sends pending bytes, then resets. Does not return on hardware.
void reboot(protocol::RebootTarget target);

/// Masks interrupts; returns the state for irq_restore. May be nested.
std::uint32_t irq_save();
void irq_restore(std::uint32_t saved);

/// Masks interrupts for a scope.
class IrqLock {
 public:
  IrqLock() : saved_(irq_save()) {}
  ~IrqLock() { irq_restore(saved_); }
  IrqLock(const IrqLock&) = delete;
  IrqLock& operator=(const IrqLock&) = delete;

 private:
  std::uint32_t saved_;
};

}  // namespace mixrig::port
