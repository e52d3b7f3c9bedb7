// SPDX-License-Identifier: Apache-2.0
// A ToF camera with the protocol of hal/wire/camera/tof_usb_protocol.md, and faults of its link.
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "hal/wire/camera/tof_usb_decoder.h"
#include "tests/board/usb_device.h"

namespace mixrig::board {

inline constexpr int kTofCodeBase_steps = 1000;  ///< pixel (0, 0) is this plus the code
inline constexpr int kTofCodes = 1 << 14;

enum class TofFault {
  kNone,
  kLosePacket,  ///< the second packet of a frame is missing
  kTruncate,    ///< the frame ends within its second packet
  kRowsBeyond,  ///< the second packet's rows lie below the picture, its checksums are correct
  kDamage,      ///< a byte of the second packet's payload is changed
  kStall,       ///< the pipe halts before the frame
};

class TofDevice final : public UsbDevice {
 public:
  /// Sends frames at `rate_hz`; if that is 0, one frame for each call of fire().
  TofDevice(Size size, double rate_hz);

  const UsbDescriptors& descriptors() const override { return descriptors_; }
  int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
  int transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) override;
  std::optional<HostTime> next_event() override;
  void clear_halt() override;
  void configured() override;

  /// An edge on the trigger line. The caller wakes the port. Thread-safe.
  void fire(std::uint32_t number);
  /// Gives one of the next frames this fault. Thread-safe.
  void fail_next(TofFault fault);
  /// Gives every n-th frame this fault; 0: no frame. Thread-safe.
  void fail_every(int n, TofFault fault);
  /// Sets the distances along the ray of all following frames, in steps of a millimetre, row by
  /// row; such frames have no code. Thread-safe. Call it once, before the host opens the device.
  void show(std::vector<std::uint16_t> steps);
  /// Depth of all pixels but the first in frames without show(), in steps of a millimetre.
  static int step_at(int x, int y) { return 500 + x + 2 * y; }

 private:
  bool begin_frame(HostTime now);
  void add_packets(device::TofKind kind, TofFault fault, HostTime now);
  int value_at(device::TofKind kind, int x, int y) const;

  device::TofDescription description_;
  bool free_;
  Duration interval_{};
  UsbDescriptors descriptors_;
  std::mutex mutex_;  ///< guards the members below
  std::vector<std::uint8_t> frame_;
  std::vector<std::uint16_t> shown_;  ///< if empty, frames show step_at() and a code
  std::size_t sent_ = 0;
  bool streaming_ = false, halted_ = false, end_ = false;
  HostTime due_{};
  std::uint32_t counter_ = 0, code_ = 0;
  std::optional<std::uint32_t> fired_;
  TofFault fault_ = TofFault::kNone, repeated_ = TofFault::kNone;
  int every_ = 0;
};

}  // namespace mixrig::board
