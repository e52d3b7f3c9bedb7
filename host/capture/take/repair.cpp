// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/repair.h"

#include <cerrno>
#include <cstdio>
#include <vector>

#include <fcntl.h>

#include "host/capture/take/disk_sync.h"
#include "host/capture/take/segments/segments.h"
#include "host/capture/take/unfinished.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr const char *kSuffix = ".partial", *kComposite = "composite";

/// Renames a folder unless the name is taken.
Result<void> rename_free(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (fs::exists(to, error))
    return Error{ErrorCode::kUsage, "'" + to.string() +
                                        "' exists and is not replaced: move it to "
                                        "another name first"};
  int failed = ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  if (failed != 0 && errno == EINVAL)  // a file system that does not know it
    failed = ::rename(from.c_str(), to.c_str());
  if (failed == 0) return sync_path(to.has_parent_path() ? to.parent_path() : fs::path("."));
  return system_error(ErrorCode::kIo, "cannot rename '" + from.string() + "'", errno);
}

bool holds_take(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "take.toml", error);
}

/// The folder in which the take is, that of a recording of composites being below.
Result<fs::path> find_take(const fs::path& folder) {
  for (const char* below : {"", "composite.partial", kComposite})
    if (const fs::path at = *below != 0 ? folder / below : folder; holds_take(at)) return at;
  return Error{ErrorCode::kNotFound, "'" + folder.string() +
                                         "' holds no take: name what a recording has left, "
                                         "NAME.partial"};
}

/// Ends the segments in `folder` that were cut off; one without a whole frame stays as it is.
Result<std::string> repair_segments(const fs::path& folder) {
  std::string what;
  for (const Segment& segment : segments_of(folder)) {
    if (!segment.is_partial) continue;
    const auto repaired = repair(segment.path);
    if (!repaired && repaired.error().code != ErrorCode::kData &&
        repaired.error().code != ErrorCode::kNotFound)
      return repaired.error();
    what = repaired ? repaired->what : to_line(repaired.error());
  }
  return what.empty() ? "'" + folder.string() + "': all of its segments are whole" : what;
}

/// Ends `take`, which is `partial` or below it. `wanted`: its name, for the line that is returned.
Result<std::string> repair_take(const fs::path& take, const fs::path& partial,
                                const fs::path& wanted) {
  const FolderLock lock(take);
  if (!lock.holds())
    return Error{ErrorCode::kUsage,
                 "'" + partial.string() + "' is still being written: end that recording first"};
  MIXRIG_ASSIGN(const WholePart part, make_whole(take));
  std::error_code error;
  fs::remove(take / "reserve", error);
  MIXRIG_TRY(sync_disk_of(take));
  return text_of({part.frames, part.cut_s, false}, wanted.string());
}

}  // namespace

Result<Repaired> repair(const fs::path& given) {
  const fs::path partial = given.has_filename() ? given : given.parent_path();
  std::error_code error;
  if (partial.extension() != kSuffix || !fs::is_directory(partial, error))
    return Error{ErrorCode::kUsage, "'" + partial.string() +
                                        "' is not what a recording that was cut off has left: name "
                                        "a folder NAME.partial"};
  Repaired repaired;
  repaired.folder = fs::path(partial).replace_extension();
  if (fs::exists(repaired.folder, error))
    return Error{ErrorCode::kUsage, "'" + repaired.folder.string() +
                                        "' exists and is not replaced: move it to another name "
                                        "first"};
  const bool is_segmented = !segments_of(partial / kComposite).empty();
  fs::path take = partial / kComposite;
  if (is_segmented) {
    MIXRIG_ASSIGN(repaired.what, repair_segments(take));
  } else {
    MIXRIG_ASSIGN(take, find_take(partial));
    MIXRIG_ASSIGN(repaired.what, repair_take(take, partial, repaired.folder));
  }
  repaired.take = repaired.folder;
  if (take != partial) {
    const fs::path inner = partial / kComposite;
    if (take != inner) MIXRIG_TRY(rename_free(take, inner));
    repaired.take /= kComposite;
  }
  MIXRIG_TRY(rename_free(partial, repaired.folder));
  return repaired;
}

}  // namespace mixrig::take
