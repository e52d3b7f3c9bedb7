// SPDX-License-Identifier: Apache-2.0
// A UVC 1.1 camera on a bulk pipe: uncompressed pictures with a bar code of their number, the usual
// controls, and an extension unit that switches it to trigger mode.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "tests/board/usb_device.h"

namespace mixrig::board {

inline constexpr int kCodeBits = 16, kCodeBlock_px = 8;

/// Reads the number in the upper left corner of a picture, bit by bit; white is 1.
int read_code(const Image<Rgb8>& picture);

class UvcDevice final : public UsbDevice {
 public:
  explicit UvcDevice(Size size);

  const UsbDescriptors& descriptors() const override { return descriptors_; }
  int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
  int transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) override;
  std::optional<HostTime> next_event() override;
  void configured() override;

  /// An edge on the trigger line. The caller wakes the port. Thread-safe.
  void fire(std::uint32_t number);
  /// Sets the luminances by column, in each row below the code, of all following pictures.
  /// Thread-safe.
  void show(std::vector<std::uint8_t> columns);
  /// Sends this picture (YUYV), without a code, from the next one on. Thread-safe.
  void show_picture(std::vector<std::uint8_t> yuyv);
  /// Ignores every n-th edge of the trigger line; 0: none.
  void miss_every(int n);
  /// Value of a control as the host last set it. `unit`: 1 camera terminal, 2 processing unit.
  int value(int unit, int selector) const;

 private:
  struct Range {
    int length, minimum, maximum, resolution, initial;
  };
  using Key = std::pair<int, int>;  ///< unit, selector
  int stream_control(const UsbSetup& setup, std::span<std::uint8_t> data);
  int unit_control(const UsbSetup& setup, std::span<std::uint8_t> data);
  bool begin_picture(HostTime now);
  void draw_picture();
  bool triggered() const;

  Size size_;
  UsbDescriptors descriptors_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::map<Key, Range> ranges_;
  std::map<Key, int> values_;
  std::array<std::uint8_t, 34> probe_{};
  Duration interval_{};
  std::vector<std::uint8_t> picture_;
  std::vector<std::uint8_t> columns_;  ///< luminances to show; if empty, a ramp
  std::vector<std::uint8_t> shown_;    ///< whole picture to show; if empty, code and columns
  std::size_t sent_ = 0;
  bool streaming_ = false, toggle_ = false;
  HostTime due_{};
  std::uint32_t number_ = 0;
  std::optional<std::uint32_t> fired_;
  int miss_every_ = 0;
  int edges_ = 0;
};

/// Maps the trigger control in uvcvideo, as a udev rule would: V4L2 then has "Trigger Mode".
/// Errors: kIo, kDevice.
Result<void> map_trigger_control(const std::string& node);

}  // namespace mixrig::board
