// SPDX-License-Identifier: Apache-2.0
// Interface of a micro-controller's bootloader: reads, erases and writes flash.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::device {

/// The smallest piece of flash that can be erased.
struct FlashSector {
  std::uint32_t address = 0, size = 0;
  bool operator==(const FlashSector&) const = default;
};

struct BootloaderInfo {
  std::string name;           ///< for people: protocol, version, chip
  std::uint16_t chip_id = 0;  ///< 0x413 for an STM32F405; 0 where it is not reported
  std::vector<FlashSector> sectors;
};

/// A bootloader, for one thread. Errors of every method: kTimeout without an answer, kDevice when
/// it refuses. write() does not verify what flash then holds: read it back.
class Bootloader {
 public:
  virtual ~Bootloader() = default;
  /// Connects to the bootloader; must be called first.
  virtual Result<BootloaderInfo> connect() = 0;
  /// Reads out.size() bytes from `address`. Over a UART the data has no checksum: read twice where
  /// it matters.
  virtual Result<void> read(std::uint32_t address, std::span<std::uint8_t> out) = 0;
  /// Erases a sector, which must be one that connect() returned.
  virtual Result<void> erase(const FlashSector& sector) = 0;
  /// Writes data. Address and size are multiples of 4; the sectors must be erased already.
  virtual Result<void> write(std::uint32_t address, std::span<const std::uint8_t> data) = 0;
  /// Leaves the bootloader and starts the program whose vector table is at `address`.
  virtual Result<void> go(std::uint32_t address) = 0;
};

}  // namespace mixrig::device
