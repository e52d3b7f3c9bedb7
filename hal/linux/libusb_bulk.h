// SPDX-License-Identifier: Apache-2.0
// A bulk pipe through libusb.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/device/usb_bulk.h"

namespace mixrig::device {

/// USB ids of the device and of the interface that carries the stream.
struct BulkAddress {
  std::uint16_t vendor = 0, product = 0;
  std::uint8_t subclass = 0, protocol = 0;  ///< of the vendor-class interface
};

/// Returns a closed pipe. Eight transfers of 64 KiB are in flight, so that the bus never waits for
/// the host. `name` is for error lines. Errors: kIo when libusb does not start.
Result<std::unique_ptr<UsbBulk>> make_libusb_bulk(const BulkAddress& address, std::string name);

}  // namespace mixrig::device
