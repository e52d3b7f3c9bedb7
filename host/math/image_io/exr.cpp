// SPDX-License-Identifier: Apache-2.0
// OpenEXR files of float channels. OpenEXR throws exceptions; they are caught here.
#include <algorithm>
#include <exception>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>

#include "hal/base/guarded.h"
#include "hal/base/partial_path.h"
#include "host/math/image_io/codecs.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::image_io {
namespace {

constexpr int kMaxChannels = 64;
/// Deflate has the highest compression ratio of OpenEXR's lossless methods, at most 1032, and a
/// value takes at least two bytes; a header that declares more values is damaged.
constexpr std::size_t kMaxValuesPerByte = 516;

Imf::Slice slice_of(float* pixels, std::ptrdiff_t stride, const Imath::Box2i& window) {
  // OpenEXR addresses pixels by their position in the data window.
  const std::ptrdiff_t origin = window.min.x + window.min.y * stride;
  return {Imf::FLOAT, reinterpret_cast<char*>(pixels - origin), sizeof(float),
          static_cast<std::size_t>(stride) * sizeof(float)};
}

/// Size of the data window; empty if the file cannot hold that many values.
Size checked_size(const Imath::Box2i& window, int channels, std::size_t file_bytes) {
  const auto width = static_cast<std::int64_t>(window.max.x) - window.min.x + 1;
  const auto height = static_cast<std::int64_t>(window.max.y) - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSidePx || height > kMaxSidePx) return {};
  const Size size{static_cast<int>(width), static_cast<int>(height)};
  const std::size_t values = size.area() * static_cast<std::size_t>(channels);
  return values / kMaxValuesPerByte > file_bytes ? Size{} : size;
}

Result<std::vector<Channel>> read(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const Imf::ChannelList& list = file.header().channels();
  int count = 0;
  for (auto it = list.begin(); it != list.end(); ++it) ++count;
  const Imath::Box2i window = file.header().dataWindow();
  const Size size = checked_size(window, count, std::filesystem::file_size(path));
  if (count > kMaxChannels || size.empty())
    return bad_picture(path.string(), "its header declares more than the file can hold");

  std::vector<Channel> channels;
  Imf::FrameBuffer frame;
  for (auto it = list.begin(); it != list.end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      return bad_picture(path.string(), std::string("channel ") + it.name() + " is subsampled");
    channels.push_back({it.name(), Image<float>(size)});
    Image<float>& pixels = channels.back().pixels;
    frame.insert(it.name(), slice_of(pixels.row(0), pixels.stride(), window));
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return channels;
}

void write(const std::filesystem::path& path, const std::vector<Channel>& channels) {
  const Size size = channels.front().pixels.size();
  Imf::Header header(size.width, size.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer frame;
  for (const Channel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    // OpenEXR only reads through the slices of an output file.
    frame.insert(channel.name, slice_of(const_cast<float*>(channel.pixels.row(0)),
                                        channel.pixels.stride(), header.dataWindow()));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(frame);
  file.writePixels(size.height);
}

void write_light(const std::filesystem::path& path, const Image<RgbHalf>& light,
                 const Image<std::uint8_t>& saturated) {
  constexpr std::uint16_t kOne = 0x3C00;
  const Size size = light.size();
  Imf::Header header(size.width, size.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Image<std::uint16_t> flag(size);
  for (int y = 0; y < size.height; ++y)
    std::transform(saturated.row(y), saturated.row(y) + size.width, flag.row(y),
                   [](std::uint8_t s) { return s != 0 ? kOne : std::uint16_t{0}; });
  Imf::FrameBuffer frame;
  const auto add = [&](const char* name, const std::uint16_t* first, std::size_t pixel_bytes,
                       std::ptrdiff_t stride) {
    header.channels().insert(name, Imf::Channel(Imf::HALF));
    // OpenEXR only reads through the slices of an output file.
    frame.insert(name,
                 Imf::Slice(Imf::HALF, reinterpret_cast<char*>(const_cast<std::uint16_t*>(first)),
                            pixel_bytes, static_cast<std::size_t>(stride) * pixel_bytes));
  };
  add("R", &light.row(0)->r, sizeof(RgbHalf), light.stride());
  add("G", &light.row(0)->g, sizeof(RgbHalf), light.stride());
  add("B", &light.row(0)->b, sizeof(RgbHalf), light.stride());
  add("saturated", flag.row(0), sizeof(std::uint16_t), flag.stride());
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(frame);
  file.writePixels(size.height);
}

/// Calls write(path of a temporary name), which may throw, and renames. `what` begins the error.
template <typename Write>
Result<void> written(const std::filesystem::path& path, const std::string& what, Write&& write) {
  PartialPath partial(path);
  try {
    write(partial.path());
  } catch (const std::exception& e) {
    return Error{ErrorCode::kIo, what + e.what()};
  }
  return partial.commit();
}

std::string cannot_write(const std::filesystem::path& path) {
  return "cannot write picture '" + path.string() + "': ";
}

}  // namespace

Result<std::vector<Channel>> read_exr(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return Error{ErrorCode::kNotFound,
                 "cannot read picture '" + path.string() + "': no such file: check the path"};
  std::vector<Channel> channels;
  MIXRIG_TRY(guarded("picture '" + path.string() + "'", [&]() -> Result<void> {
    try {
      MIXRIG_ASSIGN(channels, read(path));
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      return bad_picture(path.string(), e.what());
    }
    return {};
  }));
  return channels;
}

Result<void> write_exr(const std::filesystem::path& path, const std::vector<Channel>& channels) {
  const std::string what = cannot_write(path);
  const auto same_size = [&](const Channel& channel) {
    return !channel.pixels.empty() && channel.pixels.size() == channels.front().pixels.size();
  };
  if (channels.empty() || !std::all_of(channels.begin(), channels.end(), same_size))
    return Error{ErrorCode::kData, what + "its channels are empty or differ in size"};
  return written(path, what, [&](const auto& to) { write(to, channels); });
}

Result<void> write_light_exr(const std::filesystem::path& path, const Image<RgbHalf>& light,
                             const Image<std::uint8_t>& saturated) {
  const std::string what = cannot_write(path);
  if (light.empty() || saturated.size() != light.size())
    return Error{ErrorCode::kData, what + "its channels are empty or differ in size"};
  return written(path, what, [&](const auto& to) { write_light(to, light, saturated); });
}

}  // namespace mixrig::image_io
