// SPDX-License-Identifier: Apache-2.0
// Opens a stream of take.toml in the format that its path names. Private to this module.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/take/streams/matroska.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

/// Opens numbered pictures or a Matroska file below `root`; not a list. Errors: kNotFound, kFormat,
/// kUnsupported.
Result<std::unique_ptr<PictureStream>> open_stored(const std::filesystem::path& root,
                                                   const StreamInfo& stream, PixelKind kind);

}  // namespace mixrig::take
