// SPDX-License-Identifier: Apache-2.0
#include "tests/board/dfuse_device.h"

namespace mixrig::board {
namespace {

constexpr std::size_t kDeviceBytes = 18;
constexpr std::uint8_t kFromDevice = 0x80;

}  // namespace

DfuseDevice::DfuseDevice() {
  const auto bytes = fake::EmulatedDfuse::descriptors();
  descriptors_.speed = UsbSpeed::kFull;
  descriptors_.device.assign(bytes.begin(), bytes.begin() + kDeviceBytes);
  descriptors_.configuration.assign(bytes.begin() + kDeviceBytes, bytes.end());
  descriptors_.strings = {"STMicroelectronics", "STM32  BOOTLOADER", "MIXRIG0001",
                          bootloader_.dfu().memory_layout};
}

int DfuseDevice::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
  if ((setup.type & kFromDevice) != 0) {
    const auto got = bootloader_.receive(setup.request, setup.value, data);
    return got ? static_cast<int>(*got) : kUsbStall;
  }
  return bootloader_.send(setup.request, setup.value, data) ? 0 : kUsbStall;
}

void DfuseDevice::configured() { bootloader_.reset(); }

}  // namespace mixrig::board
