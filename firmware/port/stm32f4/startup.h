// SPDX-License-Identifier: Apache-2.0
// Functions that startup and the port share.
#pragma once

#include <cstdint>

#include "firmware/port/port.h"

namespace mixrig::stm32 {

/// Whether this is QEMU's model: it does not model the RCC, which reads 0, while on a real chip the
/// internal oscillator is on after any reset.
bool emulated();
/// Resets; the next start runs the ROM bootloader if `target` says so.
[[noreturn]] void system_reset(protocol::RebootTarget target);
/// Whether the image in flash matches its header; `crc` is the computed one.
bool image_check(std::uint32_t& crc);

}  // namespace mixrig::stm32
