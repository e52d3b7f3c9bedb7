// SPDX-License-Identifier: Apache-2.0
// A USB device in this process: descriptors and answers, for VhciPort to plug in.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/clock.h"

namespace mixrig::board {

enum class UsbSpeed { kFull = 2, kHigh = 3, kSuper = 5 };

struct UsbDescriptors {
  UsbSpeed speed = UsbSpeed::kHigh;
  std::vector<std::uint8_t> device, configuration;
  std::vector<std::string> strings;  ///< string 1 first
};

/// Packet of a control request, as USB 2.0 section 9.3 has it.
struct UsbSetup {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
};

inline constexpr int kUsbStall = -32, kUsbWait = -1, kUsbLost = -71;

/// Every method is called on the port's thread; methods for other threads must lock.
class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  virtual const UsbDescriptors& descriptors() const = 0;
  /// A class or vendor request. `data` is received data, or the buffer for the answer. Returns the
  /// bytes of the answer, or kUsbStall.
  virtual int control(const UsbSetup& setup, std::span<std::uint8_t> data) = 0;
  /// Bytes for an OUT endpoint.
  virtual void receive(int /*endpoint*/, std::span<const std::uint8_t> /*bytes*/) {}
  /// Fills one transfer of an IN endpoint, or one packet of an isochronous transfer. Returns its
  /// bytes, kUsbStall, or kUsbWait while there is nothing to send; for an isochronous packet also
  /// kUsbLost. After kUsbWait, the remaining packets of a transfer that already has some are empty.
  virtual int transmit(int /*endpoint*/, std::span<std::uint8_t> /*room*/, HostTime /*now*/) {
    return kUsbWait;
  }
  /// When transmit() will have data without another event.
  virtual std::optional<HostTime> next_event() { return std::nullopt; }
  /// The host cleared the halt of an endpoint.
  virtual void clear_halt() {}
  /// The host configured the device: it was plugged in.
  virtual void configured() {}
  /// The host selected an alternate setting.
  virtual void selected(int /*interface*/, int /*setting*/) {}
};

}  // namespace mixrig::board
