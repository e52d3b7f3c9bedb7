// SPDX-License-Identifier: Apache-2.0
// One USB device with vendor requests and a bulk IN pipe: the interface that keeps libusb out of
// the ToF drivers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::device {

/// State of a bulk pipe after pump().
enum class BulkState {
  kFlowing,
  kStalled,  ///< the device halted the pipe, or transfers failed: cancel() and submit() again
  kGone,     ///< unplugged: close() and open() again
};

/// Receives the bytes of transfers, in order, inside pump().
using BulkSink = std::function<void(std::span<const std::uint8_t>)>;

/// A USB device with a bulk IN pipe. For one thread.
class UsbBulk {
 public:
  virtual ~UsbBulk() = default;
  /// Finds the device and claims its stream interface. Errors: kNotFound, kDevice.
  virtual Result<void> open() = 0;
  /// Cancels all transfers. Does nothing when closed.
  virtual void close() = 0;
  /// Sends a vendor request to the interface; reads the answer into `in` unless that is empty.
  /// Returns the number of bytes read. Errors: kDevice.
  virtual Result<std::size_t> request(std::uint8_t request, std::uint16_t value,
                                      std::span<std::uint8_t> in) = 0;
  /// Clears a halt and submits the transfers. Errors: kDevice.
  virtual Result<void> submit() = 0;
  /// Cancels the transfers; none is in flight when it returns.
  virtual void cancel() = 0;
  /// Passes received bytes to `sink`, waiting at most `timeout`, and resubmits the transfers.
  virtual BulkState pump(Duration timeout, const BulkSink& sink) = 0;
};

}  // namespace mixrig::device
