// SPDX-License-Identifier: Apache-2.0
// Picture files: PNG, JPEG, OpenEXR. Readers fill a given image and reuse its memory if the size is
// the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hal/base/half.h"
#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::image_io {

/// Reads a PNG (8 or 16 bit, any colour type) or JPEG as 8-bit sRGB; the content decides which.
/// Errors: kNotFound, kFormat (truncated, damaged, larger than 16384 px), naming the file.
Result<void> read_rgb8(const std::filesystem::path& path, Image<Rgb8>& image);

/// Decodes PNG or JPEG bytes; `name` appears in the error line. Errors: kFormat.
Result<void> decode_rgb8(const std::uint8_t* bytes, std::size_t size, const std::string& name,
                         Image<Rgb8>& image);

/// Reads a grey PNG of 16 bit (or 8, unscaled). Errors: those of read_rgb8; kFormat for colour.
Result<void> read_gray16(const std::filesystem::path& path, Image<std::uint16_t>& image);
/// Reads a grey PNG of 8 bit. Errors: those of read_rgb8; kFormat for colour or 16 bit.
Result<void> read_gray8(const std::filesystem::path& path, Image<std::uint8_t>& image);

/// Writes a PNG under a temporary name, then renames it. Errors: kIo.
Result<void> write_png(const std::filesystem::path& path, ImageView<const Rgb8> image);
Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint8_t> image);
Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint16_t> image);

/// Returns the bytes of a PNG file. Errors: kIo for an image without pixels.
Result<std::string> encode_png(ImageView<const Rgb8> image);

/// One channel of an EXR file, 32-bit float.
struct Channel {
  std::string name;
  Image<float> pixels;
};

/// Reads all channels as float. Errors: kNotFound, kFormat.
Result<std::vector<Channel>> read_exr(const std::filesystem::path& path);
/// Writes channels of one size, ZIP compressed, under a temporary name. Errors: kIo, kData.
Result<void> write_exr(const std::filesystem::path& path, const std::vector<Channel>& channels);
/// Writes channels R, G, B and `saturated` (0 or 1), all of half precision and one size. ZIP
/// compressed, under a temporary name. Errors: kIo, kData.
Result<void> write_light_exr(const std::filesystem::path& path, const Image<RgbHalf>& light,
                             const Image<std::uint8_t>& saturated);

}  // namespace mixrig::image_io
