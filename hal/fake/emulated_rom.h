// SPDX-License-Identifier: Apache-2.0
// The UART bootloader in the system memory of an STM32F405, byte by byte (AN3155).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "hal/fake/emulated_flash.h"

namespace mixrig::fake {

class EmulatedRom {
 public:
  /// `flash` must outlive it. Sends nothing while the flash has no power.
  explicit EmulatedRom(EmulatedFlash& flash) : flash_(flash), ram_(kRamSize, 0) {}

  /// Takes a byte from the host. Answers are appended to output(); the caller erases what it sent.
  void receive(std::uint8_t byte);
  std::vector<std::uint8_t>& output() { return output_; }
  /// Resets the bootloader: it waits for the first 0x7F.
  void reset();
  /// Address of the host's Go command; the bootloader has stopped then.
  std::optional<std::uint32_t> gone_to() const { return gone_to_; }
  bool synchronized() const { return synchronized_; }

  /// Answers NACK in place of the n-th ACK from now, n >= 1.
  void nack_at(int answer) { nack_at_ = answers_ + answer; }
  int answers() const { return answers_; }
  std::uint16_t chip_id = 0x413;

 private:
  static constexpr std::uint32_t kRamBase = 0x20000000;
  static constexpr std::uint32_t kRamSize = 128 * 1024;
  static constexpr std::uint32_t kOwnRam = 12 * 1024;  ///< reserved for the bootloader

  using Handler = void (EmulatedRom::*)();
  void expect(std::size_t bytes, Handler then);
  void await_command() { expect(2, &EmulatedRom::on_command); }
  bool acknowledge();
  void refuse();
  bool take_address();

  void on_command();
  void on_read_address();
  void on_read_count();
  void on_write_address();
  void on_write_size();
  void on_write_data();
  void on_erase_count();
  void on_erase_all();
  void on_erase_pages();
  void on_go_address();
  void answer(std::span<const std::uint8_t> bytes);
  /// Returns the readable memory at `address`; empty if it may not be read.
  std::span<const std::uint8_t> readable(std::uint32_t address, std::size_t size) const;

  EmulatedFlash& flash_;
  std::vector<std::uint8_t> ram_;
  std::vector<std::uint8_t> input_;
  std::vector<std::uint8_t> output_;
  std::size_t needed_ = 1;
  Handler then_ = nullptr;
  bool synchronized_ = false;
  std::uint32_t address_ = 0;
  std::optional<std::uint32_t> gone_to_;
  int answers_ = 0;
  int nack_at_ = -1;
};

}  // namespace mixrig::fake
