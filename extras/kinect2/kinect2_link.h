// SPDX-License-Identifier: Apache-2.0
// Commands of a Kinect v2: description of the device, streams on and off. Private to this module.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "extras/kinect2/kinect2_protocol.h"
#include "extras/kinect2/usb_streams.h"
#include "hal/base/clock.h"

namespace mixrig::device {

struct Kinect2Description {
  std::string firmware, serial;
  Kinect2Infrared infrared;
  Kinect2Offsets offsets;
};

/// Sends commands to a Kinect v2. One thread at a time. Errors: those of the pipes; kDevice for
/// answers that are not valid.
class Kinect2Link {
 public:
  Kinect2Link(UsbStreams& usb, std::string uri, Clock& clock)
      : usb_(usb), uri_(std::move(uri)), clock_(clock) {}

  /// Opens the device and reads its description.
  Result<Kinect2Description> describe();
  /// Opens the device, waits until it is ready and starts its streams; the caller submits the
  /// transfers.
  Result<void> begin();
  /// Stops the streams as far as the device still answers. Precondition: no transfers are in
  /// flight.
  void end();

 private:
  Result<std::vector<std::uint8_t>> ask(const Kinect2Request& request);

  UsbStreams& usb_;
  const std::string uri_;
  Clock& clock_;
  std::uint32_t sequence_ = 0;
};

}  // namespace mixrig::device
