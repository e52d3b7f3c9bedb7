// SPDX-License-Identifier: Apache-2.0
// A take as a source of captures.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::take {

/// Opens a take folder, a take.toml, or a TUM RGB-D folder. A picture that cannot be read later is
/// kData. Errors: those of TakeReader::open.
Result<std::unique_ptr<capture::CaptureSource>> open_take_source(const std::filesystem::path& path);

}  // namespace mixrig::take
