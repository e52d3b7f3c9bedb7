// SPDX-License-Identifier: Apache-2.0
#include "host/math/image_io/exr_channel.h"

#include <algorithm>
#include <cmath>

namespace mixrig::model {

Result<Image<float>> take_channel(std::vector<image_io::Channel>& channels, const std::string& name,
                                  Size size, const std::filesystem::path& path, float least) {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const image_io::Channel& c) { return c.name == name; });
  if (found == channels.end())
    return Error{ErrorCode::kFormat,
                 "'" + path.string() + "' has no channel " + name + ": scan the background again"};
  if (found->pixels.size() != size)
    return Error{ErrorCode::kData,
                 "'" + path.string() +
                     "' has another size than size_px says beside it: scan the background again"};
  for (int y = 0; y < size.height; ++y) {
    float* row = found->pixels.row(y);
    if (std::any_of(row, row + size.width,
                    [least](float v) { return !std::isfinite(v) || v < least; }))
      return Error{ErrorCode::kData,
                   "'" + path.string() +
                       "' holds a negative or not finite value: scan the background again"};
  }
  return std::move(found->pixels);
}

}  // namespace mixrig::model
