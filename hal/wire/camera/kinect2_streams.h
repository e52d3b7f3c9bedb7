// SPDX-License-Identifier: Apache-2.0
// Puts the packets of a Kinect v2 together: raw frames from isochronous packets, colour packets
// from bulk transfers.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hal/wire/camera/kinect2_protocol.h"

namespace mixrig::device {

/// A raw frame, valid during the call.
struct Kinect2RawFrame {
  std::span<const std::uint8_t> pictures;  ///< kKinect2RawBytes: ten pictures in order
  std::uint32_t frame = 0, ticks = 0;      ///< ticks of its first picture that came
  bool whole = false;                      ///< false: pictures are missing, their bytes are old
};
using Kinect2RawSink = std::function<void(const Kinect2RawFrame&)>;

/// Takes the packets of the isochronous pipe one by one. A frame is given on when its tenth
/// picture is there, or, with some missing, when a picture of another frame comes. Nothing
/// allocates after construction. For one thread.
class Kinect2DepthStream {
 public:
  Kinect2DepthStream();

  /// An empty packet, or one that was lost or damaged (`good` false), ends a picture.
  void feed(std::span<const std::uint8_t> packet, bool good, const Kinect2RawSink& sink);
  void restart();
  /// Lost or damaged packets, pictures of a wrong length, footers that are not valid.
  std::uint64_t link_errors() const { return link_errors_; }

 private:
  void end_picture(std::span<const std::uint8_t> footer, const Kinect2RawSink& sink);
  void give(const Kinect2RawSink& sink);
  void skip_picture();

  std::vector<std::uint8_t> pending_, frame_;
  std::size_t count_ = 0;
  bool skipping_ = false;  ///< up to the next boundary
  std::uint32_t got_ = 0;  ///< bit mask of pictures
  std::uint32_t number_ = 0, ticks_ = 0;
  std::uint64_t link_errors_ = 0;
};

/// Takes the transfers of the colour pipe. Nothing allocates after construction. For one thread.
class Kinect2ColorStream {
 public:
  Kinect2ColorStream();

  void feed(std::span<const std::uint8_t> transfer,
            const std::function<void(const Kinect2ColorPacket&)>& sink);
  void restart() { count_ = 0, skipping_ = false; }
  std::uint64_t link_errors() const { return link_errors_; }

 private:
  std::vector<std::uint8_t> pending_;
  std::size_t count_ = 0;
  bool skipping_ = false;  ///< of a packet that is too long, up to its end
  std::uint64_t link_errors_ = 0;
};

}  // namespace mixrig::device
