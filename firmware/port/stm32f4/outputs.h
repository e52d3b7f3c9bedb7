// SPDX-License-Identifier: Apache-2.0
// Trigger outputs PC0..PC15: a stream of set/reset words that hardware outputs.
#pragma once

#include <cstdint>

namespace mixrig::stm32 {

/// Sets up port C; the lines stay inputs.
void outputs_init();

// QEMU has neither TIM8 nor DMA. There, TIM4's interrupt writes the same words, each at its slot.

/// Call it at the start of a master tick that was due at `tick_ns` on the emulated clock.
void emulated_outputs_tick(std::uint32_t tick_ns);
/// Handles TIM4's interrupt.
void emulated_outputs_slot();

}  // namespace mixrig::stm32
