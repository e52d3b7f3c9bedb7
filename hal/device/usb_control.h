// SPDX-License-Identifier: Apache-2.0
// Control transfers of one USB device: the interface between the DfuSe protocol and libusb.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hal/base/result.h"

namespace mixrig::device {

/// A DFU interface as the USB descriptors state it.
struct DfuInterface {
  std::uint8_t number = 0;
  std::size_t transfer_size = 0;  ///< largest data block, bytes
  std::string memory_layout;      ///< name of the alternate setting, "@Internal Flash /0x0800..."
};

/// Class requests to the interface. Errors: kDevice for a stall or a device that is gone.
class UsbControl {
 public:
  virtual ~UsbControl() = default;
  virtual const DfuInterface& dfu() const = 0;
  virtual Result<void> send(std::uint8_t request, std::uint16_t value,
                            std::span<const std::uint8_t> data) = 0;
  /// Returns the count of bytes read, at most out.size().
  virtual Result<std::size_t> receive(std::uint8_t request, std::uint16_t value,
                                      std::span<std::uint8_t> out) = 0;
};

}  // namespace mixrig::device
