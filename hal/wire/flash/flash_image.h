// SPDX-License-Identifier: Apache-2.0
// Writes a checked image to a micro-controller's flash; a partly written image never boots.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/bootloader.h"
#include "hal/device/byte_stream.h"
#include "hal/wire/flash/firmware_image.h"

namespace mixrig::device {

/// Callback for progress: name of the step, bytes done, bytes in total.
using FlashProgress = std::function<void(const char* what, std::size_t done, std::size_t total)>;

/// Content of flash before it is overwritten.
struct PreviousFlash {
  bool blank = false;
  /// The old image; all bytes of the sectors if it is not a mixrig image.
  std::vector<std::uint8_t> bytes;
};

/// Reads the content that flashing `size` bytes would overwrite.
Result<PreviousFlash> read_previous(Bootloader& bootloader, const BootloaderInfo& info,
                                    std::size_t size, const FlashProgress& progress);

/// Erases, writes all but the vector table, reads it back, then writes the vector table, with stack
/// pointer and entry point last, and reads that back.
/// If it fails midway the board does not boot and can be flashed again.
Result<void> write_flash(Bootloader& bootloader, const BootloaderInfo& info,
                         std::span<const std::uint8_t> bytes, const FlashProgress& progress);

/// Reads flash back and compares every byte. Errors: kData with the first address that differs.
Result<void> verify_flash(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                          const FlashProgress& progress);

/// Makes sure that the ROM bootloader runs behind a serial line: if it does not answer, the
/// firmware is requested to start it. Errors: kDevice while triggers run, kTimeout.
Result<void> enter_bootloader(ByteStream& stream, Clock& clock, const std::string& name);

}  // namespace mixrig::device
