// SPDX-License-Identifier: Apache-2.0
// Clock tree, time base and master tick.
#pragma once

#include <cstdint>

#include "firmware/protocol/messages.h"

namespace mixrig::stm32 {

/// Sets the core to 168 MHz from the 8 MHz crystal, or from the internal oscillator if the crystal
/// does not start; every wait is bounded.
protocol::ClockSource clocks_init();
/// Returns the clock of the APB timers (TIM2..5); TIM8 and the core run at twice that.
std::uint32_t timer_hz();

/// Starts TIM5 (microseconds), TIM2 (master tick) and the core's cycle counter.
void time_init();

/// Returns by how many ns the running tick interrupt is late.
std::uint32_t tick_late_ns();
/// Begins a measurement of a short time span; see span_ns.
std::uint32_t span_begin();
std::uint32_t span_ns(std::uint32_t begin);

// QEMU 7.2's timers run at 1 GHz / (PSC + 1), never wrap at ARR, and a write of ARR arms the next
// interrupt ARR ns from then. TIM3 with PSC 0 is the emulated clock in ns.

/// Arms the next master tick. Returns when, on the emulated clock, the present one was due.
std::uint32_t emulated_tick_rearm();

}  // namespace mixrig::stm32
