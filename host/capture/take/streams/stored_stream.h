// SPDX-License-Identifier: Apache-2.0
// Opens a stream of take.toml in the format that its path names. Private to this module.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/take/streams/matroska.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

/// Opens numbered pictures or a Matroska file below `root`; not a list. Grey pictures of 8 bits are
/// read as 16. Errors: kNotFound, kFormat, kUnsupported.
Result<std::unique_ptr<PictureStream>> open_stored(const std::filesystem::path& root,
                                                   const StreamInfo& stream, PixelKind kind);
/// Opens a depth stream as open_stored() does; a picture of 8 bits is an error when it is read.
Result<std::unique_ptr<PictureStream>> open_depth(const std::filesystem::path& root,
                                                  const StreamInfo& stream);

}  // namespace mixrig::take
