// SPDX-License-Identifier: Apache-2.0
// The flash of an STM32F405: sectors, bits that only an erase sets to 1, and power failures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mixrig::fake {

class EmulatedFlash {
 public:
  static constexpr std::uint32_t kBase = 0x08000000;
  static constexpr std::uint32_t kSize = 1024 * 1024;
  static constexpr int kSectors = 12;

  EmulatedFlash() : bytes_(kSize, 0xFF) {}

  /// Offset of a sector's first byte; for kSectors the size of flash.
  static std::uint32_t sector_begin(int sector);
  static std::optional<int> sector_of(std::uint32_t address);
  static bool contains(std::uint32_t address, std::size_t size);

  /// Writes `data` to flash. Returns false if the power is off, or fails midway: then half of it is
  /// written.
  bool program(std::uint32_t address, std::span<const std::uint8_t> data);
  bool erase_sector(int sector);
  bool erase_all();
  std::span<const std::uint8_t> read(std::uint32_t address, std::size_t size) const;
  std::span<const std::uint8_t> bytes() const { return bytes_; }
  /// Fills flash directly, without the rules of erase and program.
  void load(std::span<const std::uint8_t> image);

  /// The power fails in the middle of the n-th change (program or erase) from now, n >= 1.
  void fail_power_at(int change) { fail_at_ = changes_ + change; }
  void power_on() { powered_ = true; }
  bool powered() const { return powered_; }
  int changes() const { return changes_; }
  /// Emulates a worn cell: no erase or program changes one bit at `address`.
  void wear_out(std::uint32_t address) { worn_ = address - kBase; }

 private:
  bool begin_change(bool& failing);
  void settle();

  std::vector<std::uint8_t> bytes_;
  bool powered_ = true;
  int changes_ = 0;
  int fail_at_ = -1;
  std::optional<std::uint32_t> worn_;
};

}  // namespace mixrig::fake
