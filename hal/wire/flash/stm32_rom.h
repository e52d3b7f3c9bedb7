// SPDX-License-Identifier: Apache-2.0
// Driver of the UART bootloader in the ROM of STM32 (AN3155).
#pragma once

#include <functional>
#include <memory>

#include "hal/base/clock.h"
#include "hal/device/bootloader.h"
#include "hal/device/byte_stream.h"

namespace mixrig::device {

/// Repeats commands that fail, with shorter blocks, and counts the repeats.
class Stm32Rom final : public Bootloader {
 public:
  static constexpr std::size_t kLongestBlock = 256;

  /// `stream` and `clock` must outlive it. connect() sets the line to even parity (ptys have no
  /// parity).
  Stm32Rom(ByteStream& stream, Clock& clock) : stream_(stream), clock_(clock) {}

  Result<BootloaderInfo> connect() override;
  Result<void> read(std::uint32_t address, std::span<std::uint8_t> out) override;
  Result<void> erase(const FlashSector& sector) override;
  Result<void> write(std::uint32_t address, std::span<const std::uint8_t> data) override;
  /// Starts the program. A missing answer to the command counts as success: check that the program
  /// answers.
  Result<void> go(std::uint32_t address) override;

  /// Whether a bootloader answers to one 0x7F. Call it first: running firmware takes it as one bad
  /// byte, while any other byte would disturb the bootloader's baud rate detection.
  Result<bool> answers();
  int repeats() const { return repeats_; }

 private:
  using Bytes = std::span<const std::uint8_t>;
  static constexpr std::size_t kLongestCommand = 260;  ///< a block with its size and checksum

  Result<void> send(Bytes bytes);
  Result<void> receive(std::span<std::uint8_t> out, Duration timeout);
  Result<void> await_ack(const char* what, Duration timeout);
  Result<void> command(std::uint8_t code, const char* what);
  Result<void> send_address(std::uint32_t address, const char* what);
  Result<void> read_block(std::uint32_t address, std::span<std::uint8_t> out);
  Result<void> write_block(std::uint32_t address, Bytes data);
  Result<void> erase_sector(int sector);
  Result<std::uint16_t> read_chip_id();
  /// Repeats a failed operation. `longest` is the number of bytes that the bootloader may still
  /// wait for after a failure.
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
