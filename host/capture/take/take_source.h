// SPDX-License-Identifier: Apache-2.0
// Opens a take as a source of captures.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::take {

/// Opens a take folder, a take.toml, or a TUM RGB-D folder. Errors: those of TakeReader::open; when
/// read later, kData for a picture that cannot be read.
Result<std::unique_ptr<capture::CaptureSource>> open_take_source(const std::filesystem::path& path);

}  // namespace mixrig::take
