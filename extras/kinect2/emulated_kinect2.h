// SPDX-License-Identifier: Apache-2.0
// Emulates a Kinect v2 at its USB pipes: answers commands and replays packets, faulty ones
// included.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "extras/kinect2/usb_streams.h"

namespace mixrig::device {

/// Thread-safe. Must outlive its pipes.
class EmulatedKinect2 {
 public:
  struct Answers {
    std::string serial = "000000000001";
    std::vector<std::uint8_t> phase_offsets, infrared, color;  ///< as the device sends them
  };
  explicit EmulatedKinect2(Answers answers) : answers_(std::move(answers)) {}

  /// Makes the driver's end of the pipes; one at a time.
  std::unique_ptr<UsbStreams> pipes();

  /// Sends sub-packets of 298648 bytes one after the other, each in isochronous packets of 33792
  /// bytes and an empty one behind; they are lost unless the driver streams. Of the packets with
  /// data, counted from 0, number `lost` is marked as lost and number `cut` is 100 bytes short; -1:
  /// none.
  void send_depth(std::span<const std::uint8_t> sub_packets, int lost = -1, int cut = -1);
  /// Sends a colour packet in bulk transfers of 16384 bytes.
  void send_color(std::span<const std::uint8_t> packet);
  void unplug();
  void replug();
  void stall();  ///< halts the pipe until transfers are submitted again
  /// From now on commands are answered without their completion.
  void leave_commands_open();
  bool streaming() const;
  int starts() const;  ///< number of times the stream was switched on

 private:
  friend class EmulatedKinect2Pipes;
  struct Packet {
    std::uint8_t endpoint;
    std::vector<std::uint8_t> bytes;
    bool good;
  };
  void execute(std::span<const std::uint8_t> command);
  void send(Packet packet);

  Answers answers_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Packet> packets_;
  std::deque<std::vector<std::uint8_t>> replies_;
  bool plugged_ = true, enabled_ = false, submitted_ = false, halted_ = false, complete_ = true;
  int alternate_ = 0, starts_ = 0;
};

}  // namespace mixrig::device
