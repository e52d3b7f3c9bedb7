// SPDX-License-Identifier: Apache-2.0
// The bootloader of a micro-controller: reads, erases and writes its flash.
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
  std::uint16_t chip_id = 0;  ///< 0x413 for an STM32F405; 0 where the bootloader cannot tell
  std::vector<FlashSector> sectors;
};

/// For one thread. Errors of every method: kTimeout when it is silent, kDevice when it refuses.
/// No method trusts that flash holds what was written: read it back.
class Bootloader {
 public:
  virtual ~Bootloader() = default;
  /// Must come first.
  virtual Result<BootloaderInfo> connect() = 0;
  /// A UART carries no check sum of what is read: read twice where it matters.
  virtual Result<void> read(std::uint32_t address, std::span<std::uint8_t> out) = 0;
  /// One of those that connect() told, no other.
  virtual Result<void> erase(const FlashSector& sector) = 0;
  /// Address and size are multiples of 4; the sectors have been erased.
  virtual Result<void> write(std::uint32_t address, std::span<const std::uint8_t> data) = 0;
  /// Leaves the bootloader for the program whose vectors lie at `address`.
  virtual Result<void> go(std::uint32_t address) = 0;
};

}  // namespace mixrig::device
