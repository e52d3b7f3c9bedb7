// SPDX-License-Identifier: Apache-2.0
// Puts a checked image into a micro-controller so that half an image never boots.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/bootloader.h"
#include "hal/device/byte_stream.h"
#include "hal/linux/firmware_image.h"

namespace mixrig::device {

/// Called as work goes on: what is being done, bytes done, bytes in all.
using FlashProgress = std::function<void(const char* what, std::size_t done, std::size_t total)>;

/// What flash held before.
struct PreviousFlash {
  bool blank = false;
  /// The old image, or all bytes of the sectors where it is none of ours.
  std::vector<std::uint8_t> bytes;
};

/// Reads what flashing `size` bytes would destroy.
Result<PreviousFlash> read_previous(Bootloader& bootloader, const BootloaderInfo& info,
                                    std::size_t size, const FlashProgress& progress);

/// Erases, writes all but the vectors, reads back, then writes the vectors, stack and entry last of
/// all, and reads them back.
/// Whatever fails in between leaves a board that does not boot and can be flashed again.
Result<void> write_flash(Bootloader& bootloader, const BootloaderInfo& info,
                         std::span<const std::uint8_t> bytes, const FlashProgress& progress);

/// Reads flash back and compares every byte. Errors: kData with the first address that differs.
Result<void> verify_flash(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                          const FlashProgress& progress);

/// Brings whatever runs behind a serial line into its ROM bootloader: nothing to do where that
/// answers; else the firmware is asked. Errors: kDevice while triggers run, kTimeout.
Result<void> enter_bootloader(ByteStream& stream, Clock& clock, const std::string& name);

}  // namespace mixrig::device
