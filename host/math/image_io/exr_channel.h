// SPDX-License-Identifier: Apache-2.0
// Channels of the files of a background.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/math/image_io/image_io.h"

namespace mixrig::model {

/// Takes the channel of that name, whose size and least value must hold; a value that is not finite
/// is refused. Errors: kFormat, kData, naming the file.
Result<Image<float>> take_channel(std::vector<image_io::Channel>& channels, const std::string& name,
                                  Size size, const std::filesystem::path& path, float least = 0);

}  // namespace mixrig::model
