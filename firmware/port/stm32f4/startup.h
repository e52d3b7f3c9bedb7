// SPDX-License-Identifier: Apache-2.0
// What startup and the port share.
#pragma once

#include <cstdint>

#include "firmware/port/port.h"

namespace mixrig::stm32 {

/// Whether this is QEMU's model: there every bit of the unmodelled RCC reads 0, while on silicon
/// the internal oscillator is on after any reset.
bool emulated();
/// Resets; the next start jumps to the ROM bootloader where told so.
[[noreturn]] void system_reset(protocol::RebootTarget target);
/// The image in flash against its own header.
bool image_check(std::uint32_t& crc);

}  // namespace mixrig::stm32
