// SPDX-License-Identifier: Apache-2.0
// Turns a composite into the raw picture of a stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "host/math/geometry/camera_model.h"
#include "host/output/streams/stereo.h"
#include "host/output/streams/stream_plan.h"
#include "host/render/contract/compositor.h"

namespace mixrig::output {

/// The room without people and objects, in the view, to fill holes of a stereo pair. May be empty.
struct RoomBehind {
  Image<Rgb8> color;
  Image<float> depth_m;  ///< 0: depth or colour is unknown
};
/// Makes it of a background that stands still.
RoomBehind room_behind(const render::BackgroundView& background);

/// Not thread-safe: reuses memory between frames.
class StreamPicture {
 public:
  /// `transparent`: the set leaves parts of the picture uncovered, which the key must show.
  StreamPicture(const scene::StreamOut& out, bool transparent, RoomBehind behind);

  render::OutputMask wanted() const;
  /// Bytes of a row of the stream's picture.
  static std::size_t stride(const scene::StreamOut& out, Size view);
  /// Writes all rows, stride() bytes each. Precondition: `images` holds the wanted images.
  void draw(const render::FrameOutput& images, const geometry::Pinhole& view,
            std::span<std::uint8_t> to);
  const StereoCounts& stereo() const { return stereo_; }  ///< sums over all frames

 private:
  const Image<std::uint8_t>& key_of(const render::FrameOutput& images) const;
  void draw_color(const render::FrameOutput& images, std::size_t stride,
                  std::span<std::uint8_t> to) const;
  void draw_right(const render::FrameOutput& images, std::size_t stride,
                  std::span<std::uint8_t> to) const;
  void draw_stereo(const render::FrameOutput& images, const geometry::Pinhole& view,
                   std::size_t stride, std::span<std::uint8_t> to);

  const scene::StreamOut out_;
  const bool transparent_;
  const RoomBehind behind_;
  Image<Rgb8> pair_;
  StereoCounts stereo_;
};

}  // namespace mixrig::output
