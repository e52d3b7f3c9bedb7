// SPDX-License-Identifier: Apache-2.0
// The emulated USB bootloader (hal/fake) as a whole USB device.
#pragma once

#include "hal/fake/emulated_dfuse.h"
#include "tests/board/usb_device.h"

namespace mixrig::board {

class DfuseDevice final : public UsbDevice {
 public:
  DfuseDevice();
  const UsbDescriptors& descriptors() const override { return descriptors_; }
  int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
  void configured() override;

  /// For use while the device is unplugged.
  fake::EmulatedFlash& flash() { return flash_; }

 private:
  fake::EmulatedFlash flash_;
  fake::EmulatedDfuse bootloader_{flash_};
  UsbDescriptors descriptors_;
};

}  // namespace mixrig::board
