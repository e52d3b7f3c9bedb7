// SPDX-License-Identifier: Apache-2.0
// Makes a take of a recording that another program has made. docs/reference/take.md names the
// formats.
#pragma once

#include <filesystem>

#include "host/capture/take/foreign/foreign_take.h"

namespace mixrig::take {

/// Makes the take `out` of a file or folder, whole or not at all; pictures are copied as they are.
/// Errors: kNotFound; kFormat for a kind that is not known, or a damaged file; kUnsupported; those
/// of ForeignTake.
Result<Imported> import_recording(const std::filesystem::path& source,
                                  const std::filesystem::path& out);

}  // namespace mixrig::take
