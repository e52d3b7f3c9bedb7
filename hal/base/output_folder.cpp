// SPDX-License-Identifier: Apache-2.0
#include "hal/base/output_folder.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include <sys/stat.h>

#include "hal/base/log.h"

namespace mixrig {
namespace fs = std::filesystem;

namespace {

struct RecordedKind {
  std::string_view marker, name;
};
constexpr std::array kRecordedKinds{RecordedKind{"take.toml", "a take"},
                                    RecordedKind{"views.toml", "board views"}};

/// The first file or folder in `folder` that is newer than `marker`; empty where there is none. A
/// link is not followed.
fs::path newer_than(const fs::path& folder, const fs::path& marker) {
  struct stat made {
  }, now{};
  if (::stat(marker.c_str(), &made) != 0) return {};
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (::lstat(entry.path().c_str(), &now) != 0 || S_ISDIR(now.st_mode)) continue;
    if (std::pair(now.st_mtim.tv_sec, now.st_mtim.tv_nsec) >
        std::pair(made.st_mtim.tv_sec, made.st_mtim.tv_nsec))
      return entry.path();
  }
  return {};
}

Result<void> check_recorded(const fs::path& folder, std::string_view what, Force force) {
  if (force == Force::kChecked) return {};
  std::error_code error;
  const auto is_file = [&](const fs::directory_entry& entry) { return !entry.is_directory(error); };
  const auto files = std::count_if(fs::recursive_directory_iterator(folder, error), {}, is_file);
  const std::string holds = "output '" + folder.string() + "' holds " + std::string(what) +
                            ", files: " + std::to_string(files);
  if (force == Force::kNo)
    return Error{ErrorCode::kUsage, holds + ": name a new folder, or give --force to replace it"};
  log_warning("files", holds + "; --force replaces all of it");
  return {};
}

}  // namespace

Result<void> check_output_folder(const fs::path& folder, const char* marker, Force force) {
  std::error_code error;
  if (!fs::exists(folder, error)) return {};
  const std::string name = "output '" + folder.string() + "'";
  if (!fs::is_directory(folder, error))
    return Error{ErrorCode::kUsage, name + " is a file: name a folder, new or made by mixrig"};
  if (fs::is_empty(folder, error)) return {};
  if (!fs::exists(folder / marker, error))
    return Error{ErrorCode::kUsage,
                 name + " holds other files (no " + marker + "): name a new folder"};
  const auto* const recorded = std::ranges::find(kRecordedKinds, marker, &RecordedKind::marker);
  if (recorded != kRecordedKinds.end()) return check_recorded(folder, recorded->name, force);
  if (const fs::path theirs = newer_than(folder, folder / marker); !theirs.empty())
    return Error{ErrorCode::kUsage, name + " holds '" + theirs.lexically_relative(folder).string() +
                                        "', written after its " + marker +
                                        ": move that file, or name a new folder"};
  return {};
}

Result<void> check_output_file(const fs::path& file, std::string_view begin,
                               std::string_view option) {
  std::error_code error;
  if (file.empty() || !fs::exists(file, error) || fs::is_other(file, error)) return {};
  const std::string name = std::string(option) + " '" + file.string() + "'";
  if (fs::is_directory(file, error))
    return Error{ErrorCode::kUsage, name + " is a folder: name a file"};
  std::string there(begin.size(), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(there.data(), static_cast<std::streamsize>(there.size()));
  there.resize(static_cast<std::size_t>(stream.gcount()));
  if (there.empty() || there == begin) return {};
  return Error{ErrorCode::kUsage,
               name + " exists and holds something else: it is kept; name another file"};
}

}  // namespace mixrig
