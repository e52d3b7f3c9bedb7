// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/kinect2_streams.h"

#include <algorithm>

namespace mixrig::device {

Kinect2DepthStream::Kinect2DepthStream()
    : pending_(kKinect2PacketBytes), frame_(kKinect2RawBytes) {}

void Kinect2DepthStream::restart() {
  count_ = 0;
  skipping_ = false;
  got_ = 0;
}

void Kinect2DepthStream::skip_picture() {
  if (!skipping_) ++link_errors_;
  skipping_ = true;
  count_ = 0;
}

void Kinect2DepthStream::feed(std::span<const std::uint8_t> packet, bool good,
                              const Kinect2RawSink& sink) {
  if (!good) return skip_picture();
  if (packet.empty()) {
    if (count_ > 0) ++link_errors_;  // a picture that ended too early
    count_ = 0;
    skipping_ = false;
    return;
  }
  if (skipping_) return;
  if (count_ + packet.size() > kKinect2PacketBytes) return skip_picture();
  std::copy(packet.begin(), packet.end(), pending_.begin() + static_cast<std::ptrdiff_t>(count_));
  count_ += packet.size();
  if (count_ < kKinect2PacketBytes) return;
  count_ = 0;
  end_picture(std::span<const std::uint8_t>(pending_).subspan(kKinect2PictureBytes), sink);
}

void Kinect2DepthStream::end_picture(std::span<const std::uint8_t> bytes,
                                     const Kinect2RawSink& sink) {
  const auto footer = parse_kinect2_footer(bytes);
  if (!footer) return skip_picture();
  if (got_ != 0 && footer->frame != number_) give(sink);
  if (got_ == 0) number_ = footer->frame, ticks_ = footer->ticks;
  const auto at =
      static_cast<std::ptrdiff_t>(static_cast<std::size_t>(footer->picture) * kKinect2PictureBytes);
  std::copy_n(pending_.begin(), kKinect2PictureBytes, frame_.begin() + at);
  got_ |= 1U << footer->picture;
  if (got_ == (1U << kKinect2Pictures) - 1) give(sink);
}

void Kinect2DepthStream::give(const Kinect2RawSink& sink) {
  sink({frame_, number_, ticks_, got_ == (1U << kKinect2Pictures) - 1});
  got_ = 0;
}

Kinect2ColorStream::Kinect2ColorStream() : pending_(kKinect2MostColor) {}

void Kinect2ColorStream::feed(std::span<const std::uint8_t> transfer,
                              const std::function<void(const Kinect2ColorPacket&)>& sink) {
  if (skipping_) {
    skipping_ = !ends_kinect2_color(transfer);
    return;
  }
  if (count_ + transfer.size() > pending_.size()) {
    ++link_errors_;
    count_ = 0;
    skipping_ = !ends_kinect2_color(transfer);
    return;
  }
  std::copy(transfer.begin(), transfer.end(),
            pending_.begin() + static_cast<std::ptrdiff_t>(count_));
  count_ += transfer.size();
  const auto all = std::span<const std::uint8_t>(pending_).first(count_);
  if (!ends_kinect2_color(all)) return;
  count_ = 0;
  if (const auto packet = parse_kinect2_color_packet(all))
    sink(*packet);
  else
    ++link_errors_;
}

}  // namespace mixrig::device
