// SPDX-License-Identifier: Apache-2.0
// One USB device with commands over bulk pipes and streams over bulk and isochronous pipes: the
// interface that keeps libusb out of the Kinect driver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/usb_bulk.h"

namespace mixrig::device {

/// A request of USB 3.1, chapter 9, without data.
struct UsbRequest {
  std::uint8_t type = 0, request = 0;  ///< bmRequestType, bRequest
  std::uint16_t value = 0, index = 0;
};

/// Transfers that stay in flight on an IN pipe.
struct StreamPipe {
  std::uint8_t endpoint = 0;
  bool isochronous = false;
  int transfers = 0;
  int packets = 1;               ///< of an isochronous transfer
  std::size_t packet_bytes = 0;  ///< of a packet, or of a bulk transfer
};

/// Data of one packet of an isochronous transfer, or of one bulk transfer.
struct StreamPacket {
  std::uint8_t endpoint = 0;
  std::span<const std::uint8_t> bytes;
  bool good = true;  ///< false: lost or damaged on the bus; no bytes
};
using StreamSink = std::function<void(const StreamPacket&)>;

/// Pipes of one USB device. For one thread.
class UsbStreams {
 public:
  virtual ~UsbStreams() = default;
  /// Finds the device and claims its interfaces. Errors: kNotFound, kDevice.
  virtual Result<void> open() = 0;
  /// Cancels all transfers. Does nothing when closed.
  virtual void close() = 0;
  /// Sends a control request. Errors of this and the following functions: kDevice; kNotFound when
  /// the device is gone.
  virtual Result<void> request(const UsbRequest& request) = 0;
  virtual Result<void> set_alternate(int interface, int setting) = 0;
  virtual Result<void> write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) = 0;
  /// Returns the count of bytes of one transfer, at most out.size().
  virtual Result<std::size_t> read(std::uint8_t endpoint, std::span<std::uint8_t> out) = 0;
  /// Puts the transfers in flight. The first call allocates.
  virtual Result<void> submit(std::span<const StreamPipe> pipes) = 0;
  /// Cancels all transfers; none is in flight when it returns.
  virtual void cancel() = 0;
  /// Passes received data to `sink`, in order on each pipe, waiting at most `timeout`.
  virtual BulkState pump(Duration timeout, const StreamSink& sink) = 0;
};

}  // namespace mixrig::device
