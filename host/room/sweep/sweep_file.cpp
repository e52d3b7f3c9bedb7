// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/sweep_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSweepFile = "sweep.toml";
constexpr std::size_t kMostSweepFile_bytes = std::size_t{1} << 20;

std::string sweep_text(const SweepIdentity& identity) {
  config::Writer root;
  root.set("format", 1).set("rig", identity.rig).set("calibration", identity.calibration);
  root.set("field_deg", identity.field_deg).set("overlap", identity.overlap);
  root.set("view_frames", identity.view_frames);
  root.set_matrix("views_rad", 2, identity.views_rad);
  return root.text();
}

/// The key of the first line of `a` that `b` does not have; empty where there is none.
std::string first_other_key(const std::string& a, const std::string& b, bool views) {
  for (std::size_t begin = 0; begin < a.size();) {
    const std::size_t end = std::min(a.find('\n', begin), a.size());
    const std::string line = a.substr(begin, end - begin + 1);
    std::string key = line.substr(0, line.find(' '));
    if (key == "views_rad" && !views) return {};
    if (b.find(line) == std::string::npos) return key;
    begin = end + 1;
  }
  return {};
}

Result<void> check_same(const fs::path& folder, const SweepIdentity& identity, bool views) {
  MIXRIG_ASSIGN(const std::string there,
                config::read_text(folder / kSweepFile, kMostSweepFile_bytes));
  const std::string text = sweep_text(identity);
  std::string key = first_other_key(text, there, views);
  if (key.empty() && views && text != there) key = "views_rad";  // there are more of them
  if (key.empty()) return {};
  return Error{ErrorCode::kUsage,
               fmt::format("'{}' holds a sweep with another {} (sweep.toml): give what it was "
                           "begun with, or remove the folder to begin again",
                           folder.string(), key == "views_rad" ? "plan of views" : key)};
}

}  // namespace

Result<void> check_sweep_folder(const fs::path& folder, const SweepIdentity& identity) {
  std::error_code error;
  if (fs::exists(folder / kSweepFile, error)) return check_same(folder, identity, false);
  if (!fs::exists(folder, error) ||
      (fs::is_directory(folder, error) && fs::is_empty(folder, error)))
    return {};
  return Error{ErrorCode::kUsage, "'" + folder.string() +
                                      "', where the sweep would be kept, holds something else: "
                                      "remove it, or give another OUT"};
}

Result<void> begin_or_resume(const fs::path& folder, const SweepIdentity& identity) {
  MIXRIG_TRY(check_sweep_folder(folder, identity));
  std::error_code error;
  if (fs::exists(folder / kSweepFile, error)) return check_same(folder, identity, true);
  fs::create_directories(folder, error);
  if (error)
    return system_error(ErrorCode::kIo, "cannot make folder '" + folder.string() + "'",
                        error.value());
  return write_file(folder / kSweepFile, sweep_text(identity));
}

}  // namespace mixrig::session
