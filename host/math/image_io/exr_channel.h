// SPDX-License-Identifier: Apache-2.0
// Takes channels from the files of a background.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/math/image_io/image_io.h"

namespace mixrig::model {

/// Moves the channel `name` out of `channels`. It must have this size, and finite values of at
/// least `least`. Errors: kFormat, kData, naming the file.
Result<Image<float>> take_channel(std::vector<image_io::Channel>& channels, const std::string& name,
                                  Size size, const std::filesystem::path& path, float least = 0);

}  // namespace mixrig::model
