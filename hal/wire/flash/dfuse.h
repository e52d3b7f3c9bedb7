// SPDX-License-Identifier: Apache-2.0
// The USB bootloader of STM32: DFU 1.1 with ST's extension (AN3156).
#pragma once

#include <optional>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/device/bootloader.h"
#include "hal/device/usb_control.h"

namespace mixrig::device {

/// Returns the sectors of a DfuSe memory layout, "@NAME/0xADDRESS/COUNT*SIZEtype,...", that may be
/// read, erased and written. Empty if the text is no such layout or lists more than 1024 sectors.
std::vector<FlashSector> parse_memory_layout(std::string_view text);

class Dfuse final : public Bootloader {
 public:
  /// `usb` and `clock` must outlive it.
  Dfuse(UsbControl& usb, Clock& clock) : usb_(usb), clock_(clock) {}

  Result<BootloaderInfo> connect() override;
  Result<void> read(std::uint32_t address, std::span<std::uint8_t> out) override;
  Result<void> erase(const FlashSector& sector) override;
  Result<void> write(std::uint32_t address, std::span<const std::uint8_t> data) override;
  Result<void> go(std::uint32_t address) override;

 private:
  struct Status {
    std::uint8_t status = 0, state = 0;
    Duration poll{};
  };
  Result<Status> get_status();
  Result<void> become_idle();
  Result<void> finish_download(const char* what);
  Result<void> command(std::uint8_t code, std::uint32_t address, const char* what);

  UsbControl& usb_;
  Clock& clock_;
  std::vector<FlashSector> sectors_;
};

}  // namespace mixrig::device
