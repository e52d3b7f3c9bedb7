// SPDX-License-Identifier: Apache-2.0
// A Kinect v2 on a SuperSpeed port: the emulated device of hal/fake behind descriptors.
// Configuration, endpoints and packet sizes as libfreenect2 (at fd64c5d) uses them.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "extras/kinect2/emulated_kinect2.h"
#include "tests/board/usb_device.h"

namespace mixrig::board {

class Kinect2Device final : public UsbDevice {
 public:
  explicit Kinect2Device(device::EmulatedKinect2::Answers answers);

  const UsbDescriptors& descriptors() const override { return descriptors_; }
  int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
  void receive(int endpoint, std::span<const std::uint8_t> bytes) override;
  int transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) override;
  void configured() override;
  void selected(int interface, int setting) override;

  /// The emulated camera: call its send_depth() or send_color(), then wake the port.
  device::EmulatedKinect2& camera() { return camera_; }

 private:
  struct Packet {
    std::vector<std::uint8_t> bytes;
    bool good = true;
  };
  int answer(std::span<std::uint8_t> room);

  device::EmulatedKinect2 camera_;
  std::unique_ptr<device::UsbStreams> pipes_;
  UsbDescriptors descriptors_;
  std::vector<std::uint8_t> answer_;
  std::size_t sent_ = 0, size_ = 0;  ///< bytes of `answer_`: already transmitted, valid
  std::deque<Packet> infrared_, color_;
};

}  // namespace mixrig::board
