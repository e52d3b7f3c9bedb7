// SPDX-License-Identifier: Apache-2.0
// Opens a stream of take.toml in the format that its path names. Private to this module.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/take/streams/matroska.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

/// Numbered pictures or a Matroska file below `root`; not a list. Errors: kNotFound, kFormat,
/// kUnsupported. Grey pictures of 8 bits are read as 16.
Result<std::unique_ptr<PictureStream>> open_stored(const std::filesystem::path& root,
                                                   const StreamInfo& stream, PixelKind kind);
/// The same of depth: a picture of 8 bits is an error when it is read.
Result<std::unique_ptr<PictureStream>> open_depth(const std::filesystem::path& root,
                                                  const StreamInfo& stream);

}  // namespace mixrig::take
