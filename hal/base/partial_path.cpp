// SPDX-License-Identifier: Apache-2.0
#include "hal/base/partial_path.h"

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/left_partial.h"
#include "hal/base/log.h"
#include "hal/base/output_folder.h"

namespace mixrig {
namespace fs = std::filesystem;

namespace {

fs::path with_suffix(fs::path path, const char* suffix) {
  // "out/" has no file name; the suffix belongs to "out".
  if (!path.has_filename()) path = path.parent_path();
  path += suffix;
  return path;
}

/// Returns the target of a link, so that the link stays; else the path itself.
fs::path behind_links(fs::path path) {
  path = with_suffix(std::move(path), "");
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  fs::path target = fs::canonical(path, error);
  return error ? path : target;
}

/// Whether the path is a pipe or a device, such as /dev/null: it is written to, never replaced.
bool is_special(const fs::path& path) {
  std::error_code error;
  return fs::is_other(path, error);
}

/// Gives a new file the mode, and where it may the owner, of the file that it will replace.
void take_rights(const fs::path& from, const fs::path& to) {
  struct stat old {};
  if (::stat(from.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return;
  if (::chown(to.c_str(), old.st_uid, old.st_gid) != 0 &&
      ::chown(to.c_str(), static_cast<uid_t>(-1), old.st_gid) != 0)
    old.st_mode &= ~static_cast<mode_t>(S_ISUID | S_ISGID);
  ::chmod(to.c_str(), old.st_mode & 07777);
}

/// Whether a program has locked the folder, as one that records does.
bool is_locked(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool locked = fd >= 0 && ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (fd >= 0) ::close(fd);
  return locked;
}

Result<void> write_bytes(const fs::path& file_path, const fs::path& shown, std::string_view bytes) {
  std::ofstream file(file_path, std::ios::binary);
  if (file_path != shown) take_rights(shown, file_path);  // before it holds anything
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file) return {};
  return system_error(ErrorCode::kIo, "cannot write '" + shown.string() + "'", errno);
}

/// Whether nobody may write what is there.
bool is_write_protected(const fs::path& path) {
  constexpr auto kWrite = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  std::error_code absent;
  const fs::file_status status = fs::status(path, absent);
  return fs::exists(status) && (status.permissions() & kWrite) == fs::perms::none;
}

}  // namespace

fs::path partial_of(const fs::path& wanted) {
  return with_suffix(behind_links(wanted), ".partial");
}

Result<void> set_aside_left(const fs::path& wanted) {
  const fs::path partial = partial_of(wanted);
  std::error_code error;
  if (!fs::is_directory(partial, error) || fs::is_empty(partial, error)) return {};
  bool written = is_locked(partial);
  for (const fs::directory_entry& entry : fs::directory_iterator(partial, error))
    written |= entry.is_directory(error) && is_locked(entry.path());
  if (written)
    return Error{ErrorCode::kUsage, "'" + partial.string() +
                                        "' is being written by another program: end that, or give "
                                        "another name"};
  const fs::path name = fs::path(partial).replace_extension();
  fs::path aside;
  for (int i = 1; aside.empty() || fs::exists(aside, error); ++i)
    aside = with_suffix(name, ("." + std::to_string(i) + ".partial").c_str());
  fs::rename(partial, aside, error);
  if (error)
    return system_error(ErrorCode::kIo, "cannot rename '" + partial.string() + "'", error.value());
  log_warning("files", "'" + partial.string() +
                           "' holds what a run that was cut off has left: it is '" +
                           aside.string() + "' now");
  return {};
}

PartialPath::PartialPath(fs::path wanted)
    : wanted_(behind_links(std::move(wanted))), partial_(partial_of(wanted_)) {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

PartialPath::PartialPath(PartialPath&& other) noexcept
    : wanted_(std::exchange(other.wanted_, {})), partial_(std::exchange(other.partial_, {})) {}

PartialPath& PartialPath::operator=(PartialPath&& other) noexcept {
  std::swap(wanted_, other.wanted_);
  std::swap(partial_, other.partial_);
  return *this;
}

PartialPath::~PartialPath() {
  std::error_code ignored;
  if (!partial_.empty()) fs::remove_all(partial_, ignored);
}

Result<void> PartialPath::commit() {
  std::error_code error;
  const bool replaces_folder = fs::is_directory(wanted_, error);
  if (is_special(wanted_) || (replaces_folder && !fs::is_directory(partial_, error)))
    return Error{ErrorCode::kUsage, "cannot write '" + wanted_.string() + "': it is a " +
                                        (replaces_folder ? "folder" : "device") + ": name a file"};
  // Renaming asks for rights on the folder alone.
  if (!replaces_folder && is_write_protected(wanted_))
    return Error{ErrorCode::kIo, "'" + wanted_.string() +
                                     "' is write-protected: permit writing (chmod u+w), or name "
                                     "another file"};
  // A folder cannot be renamed over one that holds files, so the old one is renamed first.
  const fs::path old = with_suffix(wanted_, ".replaced");
  if (replaces_folder) {
    fs::remove_all(old, error);
    fs::rename(wanted_, old, error);
  }
  if (!replaces_folder) take_rights(wanted_, partial_);
  fs::rename(partial_, wanted_, error);
  std::error_code ignored;
  if (error && replaces_folder) fs::rename(old, wanted_, ignored);
  if (error)
    return system_error(ErrorCode::kIo, "cannot write '" + wanted_.string() + "'", error.value());
  if (replaces_folder) fs::remove_all(old, ignored);
  return {};
}

Result<PartialPath> make_partial_folder(const fs::path& given, const char* marker) {
  const fs::path folder = with_suffix(given, "");
  if (folder.empty()) return Error{ErrorCode::kUsage, "the output folder has no name: name one"};
  MIXRIG_TRY(check_output_folder(folder, marker, Force::kChecked));
  MIXRIG_TRY(set_aside_left(folder));
  PartialPath partial(folder);
  std::error_code error;
  if (!fs::create_directories(partial.path(), error))
    return system_error(ErrorCode::kIo, "cannot make folder " + partial.path().string(),
                        error.value());
  return partial;
}

Result<void> write_file(const fs::path& path, std::string_view bytes) {
  if (is_special(path)) return write_bytes(path, path, bytes);
  PartialPath partial(path);
  MIXRIG_TRY(write_bytes(partial.path(), path, bytes));
  return partial.commit();
}

}  // namespace mixrig
