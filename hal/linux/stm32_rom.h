// SPDX-License-Identifier: Apache-2.0
// The UART bootloader in the ROM of STM32 (AN3155).
#pragma once

#include <functional>
#include <memory>

#include "hal/base/clock.h"
#include "hal/device/bootloader.h"
#include "hal/device/byte_stream.h"

namespace mixrig::device {

/// Commands that fail are repeated, with shorter blocks; the count of repeats is kept.
class Stm32Rom final : public Bootloader {
 public:
  static constexpr std::size_t kLongestBlock = 256;

  /// Both outlive it. The line is set to even parity by connect() (ptys have none to set).
  Stm32Rom(ByteStream& stream, Clock& clock) : stream_(stream), clock_(clock) {}

  Result<BootloaderInfo> connect() override;
  Result<void> read(std::uint32_t address, std::span<std::uint8_t> out) override;
  Result<void> erase(const FlashSector& sector) override;
  Result<void> write(std::uint32_t address, std::span<const std::uint8_t> data) override;
  /// Silence after the command counts as gone: greet what should run then.
  Result<void> go(std::uint32_t address) override;

  /// Whether a bootloader answers to one 0x7F. To running firmware that is one bad byte, while
  /// any other byte would spoil the bootloader's search for the baud rate: ask this first.
  Result<bool> answers();
  int repeats() const { return repeats_; }

 private:
  using Bytes = std::span<const std::uint8_t>;
  static constexpr std::size_t kLongestCommand = 260;  ///< a block with its size and check sum

  Result<void> send(Bytes bytes);
  Result<void> receive(std::span<std::uint8_t> out, Duration timeout);
  Result<void> await_ack(const char* what, Duration timeout);
  Result<void> command(std::uint8_t code, const char* what);
  Result<void> send_address(std::uint32_t address, const char* what);
  Result<void> read_block(std::uint32_t address, std::span<std::uint8_t> out);
  Result<void> write_block(std::uint32_t address, Bytes data);
  Result<void> erase_sector(int sector);
  Result<std::uint16_t> read_chip_id();
  /// `longest`: bytes for which the bootloader may be left waiting.
  Result<void> repeat(const std::function<Result<void>()>& operation,
                      std::size_t longest = kLongestCommand);
  Result<bool> fill_until_refused(std::size_t bursts, std::size_t size);
  Result<void> resynchronize(std::size_t longest);
  void adapt_block(bool passed);
  void discard_input();

  ByteStream& stream_;
  Clock& clock_;
  std::vector<FlashSector> sectors_;
  std::size_t block_ = kLongestBlock;
  int passed_in_a_row_ = 0;
  int repeats_ = 0;
};

}  // namespace mixrig::device
