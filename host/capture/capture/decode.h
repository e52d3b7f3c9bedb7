// SPDX-License-Identifier: Apache-2.0
// Decodes colour pictures from the formats that cameras send.
//
// libyuv converts YUV, since it is faster than plain loops, except limited BT.709 and BT.2020,
// whose blue factors it cannot hold (yuv.cpp). It rounds the blue factor 2.017 of BT.601 to 2:
// against exact arithmetic the largest error is 2.6 of 255 in blue, and below 1 in red and green.
// Tables for another transfer than sRGB cost time for each sample.
//
// MJPEG is decoded by libjpeg-turbo through its libjpeg interface (host/math/image_io). The
// TurboJPEG interface gives the same pixels, is no faster, allocates in each frame as well, and
// reports only the first warning: a picture with stray bytes between its markers, which is
// harmless, cannot be distinguished from a truncated one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/raw_picture.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/device/frame.h"

namespace mixrig::capture {

/// Settings that convert the samples of a camera to linear light.
struct ColorSettings {
  device::ColorEncoding encoding{};
  double black = 0;                      ///< sample without light, 0..1 of full scale, below 1
  std::array<double, 3> gains{1, 1, 1};  ///< factors of linear red, green and blue light
  bool limited_samples = false;          ///< samples other than YUV have the limited range
  bool mirrored = false;                 ///< JPEG pictures are mirrored left to right
};

/// Returns the linear light 0..1 of an R'G'B' sample 0..1 above black.
double linear_light(const device::ColorEncoding& encoding, double sample);

/// Makes 8-bit sRGB of the pictures of one camera: light = gain * linear((sample - black) /
/// (1 - black)), then its sRGB value, from tables. A camera that sends sRGB needs no tables and no
/// extra time. Not thread-safe.
class ColorDecoder {
 public:
  explicit ColorDecoder(const ColorSettings& settings = {});

  /// Decodes any frame but depth; keeps the memory of `out`. YUV is converted by its matrix and
  /// range, JPEG as JFIF defines it; rows of NV12 hold an even number of bytes. Bayer is
  /// interpolated bilinearly.
  /// Errors: kData if there are fewer bytes than the picture needs, or the format has no colours;
  /// kFormat for a damaged JPEG.
  Result<void> decode(const device::Frame& frame, Image<Rgb8>& out);
  /// Returns the undecoded frame with the tables that decode() would apply, if its samples have 8
  /// bits and are YUV, grey or Bayer; empty for other formats and if bytes are missing. It borrows
  /// frame and decoder.
  std::optional<RawPicture> raw(const device::Frame& frame) const;

 private:
  static constexpr int kBits = 12;  ///< bits of a sample that indexes a table
  using Table = std::array<std::uint8_t, 1 << kBits>;
  void decode_gray(const device::Frame& frame, int bytes, Image<Rgb8>& out) const;
  void decode_bayer(const device::Frame& frame, Image<Rgb8>& out);
  void map_bayer_row(const device::Frame& frame, int bytes, int red_x, int red_y, int y,
                     std::uint8_t* out) const;
  void map_rgb(Image<Rgb8>& image) const;
  bool plain() const { return tables_.empty(); }

  device::ColorEncoding encoding_;
  bool mirrored_;
  std::vector<Table> tables_;  ///< for red, green, blue; empty: samples are sRGB already
  std::array<std::array<std::uint8_t, 256>, 3> byte_tables_{};  ///< tables of 8-bit samples
  SampleTable samples_{};                                       ///< byte_tables_ for raw()
  std::vector<std::uint8_t> rows_;                              ///< unpacked rows of Bayer samples
};

}  // namespace mixrig::capture
