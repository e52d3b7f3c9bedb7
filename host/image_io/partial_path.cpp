// SPDX-License-Identifier: Apache-2.0
// Renaming what was written whole.
#include "host/image_io/partial_path.h"

#include <system_error>
#include <utility>

namespace mixrig::image_io {
namespace fs = std::filesystem;

namespace {

fs::path with_suffix(fs::path path, const char* suffix) {
  // "out/" has no file name; the suffix belongs to "out".
  if (!path.has_filename()) path = path.parent_path();
  path += suffix;
  return path;
}

}  // namespace

PartialPath::PartialPath(fs::path wanted)
    : wanted_(with_suffix(std::move(wanted), "")), partial_(with_suffix(wanted_, ".partial")) {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

PartialPath::~PartialPath() {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

Result<void> PartialPath::commit() {
  std::error_code error;
  // A folder cannot be renamed over one that holds files, so the old one steps aside.
  const fs::path old = with_suffix(wanted_, ".replaced");
  const bool replaces_folder = fs::is_directory(wanted_, error);
  if (replaces_folder) {
    fs::remove_all(old, error);
    fs::rename(wanted_, old, error);
  }
  fs::rename(partial_, wanted_, error);
  std::error_code ignored;
  if (error && replaces_folder) fs::rename(old, wanted_, ignored);
  if (error)
    return system_error(ErrorCode::kIo, "cannot write '" + wanted_.string() + "'", error.value());
  if (replaces_folder) fs::remove_all(old, ignored);
  return {};
}

}  // namespace mixrig::image_io
