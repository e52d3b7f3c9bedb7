// SPDX-License-Identifier: Apache-2.0
// From file names to decoders.
#include "host/math/image_io/image_io.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>

#include "hal/base/guarded.h"
#include "host/math/image_io/codecs.h"
#include "host/math/image_io/depth_picture.h"
#include "host/math/image_io/picture_size.h"

namespace mixrig::image_io {
namespace {

/// No picture of at most kMaxSidePx per side needs a larger file.
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path) {
  std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  const std::string what = "cannot read picture '" + path.string() + "'";
  if (!file) return system_error(ErrorCode::kNotFound, what, errno);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return system_error(ErrorCode::kFormat, what, error.value());
  if (size > kMaxFileBytes) return bad_picture(path.string(), "larger than 2 GiB");
  std::vector<std::uint8_t> bytes(size);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  return bytes;
}

/// Memory that a picture cannot get is an error of that picture.
template <typename Work>
Result<void> guarded_picture(const std::string& name, Work&& work) {
  return guarded("picture '" + name + "'", std::forward<Work>(work));
}

template <typename T>
Result<void> read_gray(const std::filesystem::path& path, Image<T>& image) {
  return guarded_picture(path.string(), [&]() -> Result<void> {
    MIXRIG_ASSIGN(const auto bytes, read_file(path));
    if (!is_png(bytes)) return bad_picture(path.string(), "not a PNG file", "use a grey PNG");
    return decode_png(bytes, path.string(), image);
  });
}

/// Replaces control characters: messages of a library may contain bytes of the file, and must stay
/// one line.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  return text;
}

}  // namespace

Error bad_picture(const std::string& name, const std::string& why, const std::string& what_to_do) {
  return Error{ErrorCode::kFormat,
               "cannot read picture '" + name + "': " + printable(why) + ": " + what_to_do};
}

namespace {

Error neither(Bytes bytes, const std::string& name) {
  return bad_picture(name, bytes.empty() ? "empty" : "neither PNG nor JPEG",
                     "use a PNG or JPEG file");
}

}  // namespace

Result<void> decode_rgb8(const std::uint8_t* data, std::size_t size, const std::string& name,
                         Image<Rgb8>& image) {
  const Bytes bytes(data, size);
  return guarded_picture(name, [&]() -> Result<void> {
    if (is_png(bytes)) return decode_png(bytes, name, image);
    if (is_jpeg(bytes)) return decode_jpeg(bytes, name, image);
    return neither(bytes, name);
  });
}

Result<Size> picture_size(Bytes bytes, const std::string& name) {
  if (is_png(bytes)) return png_size(bytes, name);
  if (is_jpeg(bytes)) return jpeg_size(bytes, name);
  return neither(bytes, name);
}

Result<void> read_rgb8(const std::filesystem::path& path, Image<Rgb8>& image) {
  return guarded_picture(path.string(), [&]() -> Result<void> {
    MIXRIG_ASSIGN(const auto bytes, read_file(path));
    return decode_rgb8(bytes.data(), bytes.size(), path.string(), image);
  });
}

Result<void> read_gray16(const std::filesystem::path& path, Image<std::uint16_t>& image) {
  return read_gray(path, image);
}

Result<void> read_depth16(const std::filesystem::path& path, Image<std::uint16_t>& image) {
  constexpr std::size_t kBitsAt = 24;  // of the header, which comes first (PNG, 11.2.2)
  return guarded_picture(path.string(), [&]() -> Result<void> {
    MIXRIG_ASSIGN(const auto bytes, read_file(path));
    if (!is_png(bytes))
      return bad_picture(path.string(), "not a PNG file", "use a grey PNG of 16 bits");
    if (bytes.size() > kBitsAt && bytes[kBitsAt] <= 8)
      return Error{ErrorCode::kFormat, "depth picture '" + path.string() + "' has " +
                                           std::to_string(bytes[kBitsAt]) +
                                           " bits a pixel: depth needs 16 (was it converted for "
                                           "display?): export it again as grey PNG of 16 bits"};
    return decode_png(bytes, path.string(), image);
  });
}

Result<void> read_gray8(const std::filesystem::path& path, Image<std::uint8_t>& image) {
  return read_gray(path, image);
}

}  // namespace mixrig::image_io
