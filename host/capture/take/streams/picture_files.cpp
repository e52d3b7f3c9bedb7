// SPDX-License-Identifier: Apache-2.0
// Picture files as a stream.
#include "host/capture/take/streams/picture_files.h"

#include <algorithm>
#include <utility>

#include "host/math/image_io/depth_picture.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {

Result<NumberedName> NumberedName::parse(const std::string& pattern) {
  const Error error{ErrorCode::kFormat, "\"" + pattern +
                                            "\" needs exactly one number: write %d or %06d in its "
                                            "place, or name a .mkv file"};
  const std::size_t percent = pattern.find('%');
  if (percent == std::string::npos) return error;
  NumberedName name;
  std::size_t at = percent + 1;
  if (at + 1 < pattern.size() && pattern[at] == '0' && pattern[at + 1] >= '1' &&
      pattern[at + 1] <= '9') {
    name.digits_ = static_cast<std::size_t>(pattern[at + 1] - '0');
    at += 2;
  }
  if (at >= pattern.size() || pattern[at] != 'd') return error;
  name.before_ = pattern.substr(0, percent);
  name.after_ = pattern.substr(at + 1);
  if (name.after_.find('%') != std::string::npos) return error;
  return name;
}

std::string NumberedName::with(int number) const {
  const std::string digits = std::to_string(number);
  const std::size_t zeros = digits_ > digits.size() ? digits_ - digits.size() : 0;
  return before_ + std::string(zeros, '0') + digits + after_;
}

Result<void> PictureFiles::read(int index, Image<Rgb8>& image) {
  return image_io::read_rgb8(path_of_(index), image);
}

Result<void> PictureFiles::read(int index, Image<std::uint16_t>& image) {
  if (needs_16_bits_) return image_io::read_depth16(path_of_(index), image);
  return image_io::read_gray16(path_of_(index), image);
}

Result<void> PictureFiles::read(int index, Image<float>& image) {
  MIXRIG_ASSIGN(auto channels, image_io::read_exr(path_of_(index)));
  const auto is_z = [](const image_io::Channel& channel) { return channel.name == "Z"; };
  auto found = std::find_if(channels.begin(), channels.end(), is_z);
  if (found == channels.end() && channels.size() == 1) found = channels.begin();
  if (found == channels.end())
    return Error{ErrorCode::kFormat, "'" + name(index) + "' has no channel Z: store depth as Z"};
  image = std::move(found->pixels);
  return {};
}

}  // namespace mixrig::take
