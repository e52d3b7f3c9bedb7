// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/stream_picture.h"

#include <algorithm>
#include <cmath>

#include "hal/base/srgb.h"

namespace mixrig::output {
namespace {

using Picture = scene::StreamOut::Picture;

void put_bgrx(const Rgb8& c, std::uint8_t* to) { to[0] = c.b, to[1] = c.g, to[2] = c.r; }

/// Depth as a byte: 255 at near, 0 at far, linear in 1/z; 0 where it is unknown.
std::uint8_t nearness(float z_m, double near_m, double far_m) {
  if (!(z_m > 0)) return 0;
  const double share = (1 / static_cast<double>(z_m) - 1 / far_m) / (1 / near_m - 1 / far_m);
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
}

std::uint16_t millimetres(float z_m) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(1e3F * z_m, 0.0F, 65535.0F)));
}

}  // namespace

RoomBehind room_behind(const render::BackgroundView& background) {
  RoomBehind room;
  if (background.depth_m.empty() || background.color.empty()) return room;
  const Size size = background.depth_m.size;
  room.color.reset(size), room.depth_m.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Rgbf& c = background.color.row(y)[x];
      const bool known = c.r >= 0;
      room.color.at(x, y) = known ? Rgb8{srgb_byte_from_linear(c.r), srgb_byte_from_linear(c.g),
                                         srgb_byte_from_linear(c.b)}
                                  : Rgb8{};
      room.depth_m.at(x, y) = known ? background.depth_m.row(y)[x] : 0;
    }
  return room;
}

StreamPicture::StreamPicture(const scene::StreamOut& out, bool transparent, RoomBehind behind)
    : out_(out), transparent_(transparent), behind_(std::move(behind)) {}

render::OutputMask StreamPicture::wanted() const {
  const render::OutputMask key = transparent_ ? render::kAlpha : render::kMatte;
  switch (out_.picture) {
    case Picture::kFill:
      return render::kColor;
    case Picture::kKey:
      return key;
    case Picture::kDepth:
      return render::kMixedDepth;
    case Picture::kFillKey:
    case Picture::kAlpha:
      return render::kColor | key;
    case Picture::kDepth2d:
    case Picture::kStereo:
      break;
  }
  return render::kColor | render::kMixedDepth;
}

std::size_t StreamPicture::stride(const scene::StreamOut& out, Size view) {
  const auto width = static_cast<std::size_t>(stream_size(out.picture, view).width);
  return (width * bytes_per_pixel(pixels_of(out.picture)) + 3) / 4 * 4;
}

const Image<std::uint8_t>& StreamPicture::key_of(const render::FrameOutput& images) const {
  return transparent_ ? images.alpha : images.matte;
}

void StreamPicture::draw(const render::FrameOutput& images, const geometry::Pinhole& view,
                         std::span<std::uint8_t> to) {
  const std::size_t row = stride(out_, view.size_px);
  switch (out_.picture) {
    case Picture::kKey:
      for (int y = 0; y < view.size_px.height; ++y)
        std::copy_n(key_of(images).row(y), view.size_px.width,
                    to.data() + static_cast<std::size_t>(y) * row);
      return;
    case Picture::kDepth:
      for (int y = 0; y < view.size_px.height; ++y) {
        std::uint8_t* at = to.data() + static_cast<std::size_t>(y) * row;
        for (int x = 0; x < view.size_px.width; ++x, at += 2) {
          const std::uint16_t mm = millimetres(images.mixed_depth_m.row(y)[x]);
          at[0] = static_cast<std::uint8_t>(mm & 255U);
          at[1] = static_cast<std::uint8_t>(mm >> 8);
        }
      }
      return;
    case Picture::kStereo:
      return draw_stereo(images, view, row, to);
    case Picture::kFillKey:
    case Picture::kDepth2d:
      draw_color(images, row, to);
      return draw_right(images, row, to);
    case Picture::kFill:
    case Picture::kAlpha:
      break;
  }
  draw_color(images, row, to);
}

/// Draws the composite, with the key as alpha where the stream has one.
void StreamPicture::draw_color(const render::FrameOutput& images, std::size_t stride,
                               std::span<std::uint8_t> to) const {
  const bool alpha = out_.picture == Picture::kAlpha;
  for (int y = 0; y < images.color.height(); ++y) {
    std::uint8_t* at = to.data() + static_cast<std::size_t>(y) * stride;
    for (int x = 0; x < images.color.width(); ++x, at += 4) {
      put_bgrx(images.color.row(y)[x], at);
      at[3] = alpha ? key_of(images).row(y)[x] : 255;
    }
  }
}

/// Draws the second picture beside the composite: key, or nearness.
void StreamPicture::draw_right(const render::FrameOutput& images, std::size_t stride,
                               std::span<std::uint8_t> to) const {
  const Size size = images.color.size();
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t* at =
        to.data() + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(size.width);
    for (int x = 0; x < size.width; ++x, at += 4) {
      const std::uint8_t v =
          out_.picture == Picture::kFillKey
              ? key_of(images).row(y)[x]
              : nearness(images.mixed_depth_m.row(y)[x], out_.near_m, out_.far_m);
      put_bgrx({v, v, v}, at);
      at[3] = 255;
    }
  }
}

void StreamPicture::draw_stereo(const render::FrameOutput& images, const geometry::Pinhole& view,
                                std::size_t stride, std::span<std::uint8_t> to) {
  StereoPair pair(
      {view.fx_px, out_.eye_m, out_.screen_m, 0.01 * out_.most_disparity_pct * view.size_px.width});
  DepthPicture behind;
  if (behind_.color.size() == view.size_px) behind = {behind_.color.view(), behind_.depth_m.view()};
  const StereoCounts counts =
      pair.draw({images.color.view(), images.mixed_depth_m.view()}, behind, pair_);
  stereo_.seen += counts.seen, stereo_.behind += counts.behind, stereo_.guessed += counts.guessed;
  for (int y = 0; y < pair_.height(); ++y) {
    std::uint8_t* at = to.data() + static_cast<std::size_t>(y) * stride;
    for (int x = 0; x < pair_.width(); ++x, at += 4) put_bgrx(pair_.row(y)[x], at), at[3] = 255;
  }
}

}  // namespace mixrig::output
