// SPDX-License-Identifier: Apache-2.0
#include "host/app/output_folder.h"

#include <cerrno>
#include <fstream>
#include <utility>

namespace mixrig::app {
namespace fs = std::filesystem;
namespace {

Error io_error(const std::string& what, const fs::path& path, const std::error_code& code) {
  return system_error(ErrorCode::kIo, what + " " + path.string(), code.value());
}

fs::path with_suffix(const fs::path& path, const char* suffix) {
  fs::path out = path;
  return out += suffix;
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder, fs::path staging)
    : folder_(std::move(folder)), staging_(std::move(staging)) {}
OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)), staging_(std::exchange(other.staging_, {})) {}
OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(staging_, other.staging_);
  return *this;
}
OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

Result<OutputFolder> OutputFolder::create(const fs::path& given, const char* marker) {
  const fs::path folder = given.has_filename() ? given : given.parent_path();
  if (folder.empty()) return Error{ErrorCode::kUsage, "the output folder has no name"};
  std::error_code code;
  if (fs::exists(folder, code)) {
    if (!fs::is_directory(folder, code))
      return Error{ErrorCode::kUsage, "output " + folder.string() +
                                          " is a file: name a folder, new or made by mixrig"};
    if (!fs::is_empty(folder, code) && !fs::exists(folder / marker, code))
      return Error{ErrorCode::kUsage, "output " + folder.string() + " holds other files (no " +
                                          marker + "): name a new folder"};
  }
  const fs::path staging = with_suffix(folder, ".partial");
  fs::remove_all(staging, code);
  if (!fs::create_directories(staging, code)) return io_error("cannot make folder", staging, code);
  return OutputFolder(folder, staging);
}

Result<void> OutputFolder::finish() {
  std::error_code code;
  const fs::path old = with_suffix(folder_, ".old");
  fs::remove_all(old, code);
  const bool replaces = fs::exists(folder_, code);
  if (replaces) fs::rename(folder_, old, code);
  if (code) return io_error("cannot move away", folder_, code);
  fs::rename(staging_, folder_, code);
  if (code) return io_error("cannot rename to", folder_, code);
  staging_.clear();
  if (replaces) fs::remove_all(old, code);
  return {};
}

Result<void> write_text(const fs::path& path, const std::string& text) {
  const fs::path partial = with_suffix(path, ".partial");
  std::ofstream file(partial, std::ios::binary);
  file << text;
  file.close();
  std::error_code code;
  if (file) {
    fs::rename(partial, path, code);
    if (!code) return {};
  }
  const int reason = code ? code.value() : errno;
  fs::remove(partial, code);
  return system_error(ErrorCode::kIo, "cannot write " + path.string(), reason);
}

}  // namespace mixrig::app
