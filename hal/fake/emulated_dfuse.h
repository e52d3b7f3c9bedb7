// SPDX-License-Identifier: Apache-2.0
// The USB bootloader of an STM32F405 at the level of control transfers (DFU 1.1, AN3156).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hal/device/usb_control.h"
#include "hal/fake/emulated_flash.h"

namespace mixrig::fake {

class EmulatedDfuse final : public device::UsbControl {
 public:
  /// `flash` must outlive it.
  explicit EmulatedDfuse(EmulatedFlash& flash);

  const device::DfuInterface& dfu() const override { return interface_; }
  Result<void> send(std::uint8_t request, std::uint16_t value,
                    std::span<const std::uint8_t> data) override;
  Result<std::size_t> receive(std::uint8_t request, std::uint16_t value,
                              std::span<std::uint8_t> out) override;

  /// Refuses the n-th request from now, n >= 1.
  void stall_at(int request) { stall_at_ = requests_ + request; }
  int requests() const { return requests_; }
  std::optional<std::uint32_t> gone_to() const { return gone_to_; }
  void reset();
  void set_layout(std::string layout) { interface_.memory_layout = std::move(layout); }

  /// Device and configuration descriptors, as sysfs shows them.
  static std::vector<std::uint8_t> descriptors();

 private:
  Result<void> count_request();
  Result<void> download(std::uint16_t block, std::span<const std::uint8_t> data);
  void perform();
  std::array<std::uint8_t, 6> status();

  EmulatedFlash& flash_;
  device::DfuInterface interface_;
  std::uint8_t state_ = 2;
  std::uint8_t status_ = 0;
  std::uint32_t pointer_ = EmulatedFlash::kBase;
  std::uint16_t block_ = 0;
  std::vector<std::uint8_t> pending_;
  bool leaving_ = false;
  int requests_ = 0;
  int stall_at_ = -1;
  std::optional<std::uint32_t> gone_to_;
};

}  // namespace mixrig::fake
