// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/disk_sync.h"

#include <cerrno>
#include <chrono>
#include <set>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/guarded.h"
#include "hal/base/thread_priority.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr auto kSyncEvery = std::chrono::seconds(1);
/// From so many new files on, one call for the whole disk costs less than one for each file.
constexpr std::size_t kMostSingleFiles = 8;

class OpenFile {
 public:
  explicit OpenFile(const fs::path& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

/// A file system that cannot be told to write, as some of networks, is no fault of the recording.
Result<void> checked(int result, const fs::path& path) {
  if (result == 0 || errno == EINVAL || errno == EROFS || errno == ENOSYS) return {};
  return system_error(ErrorCode::kIo, "cannot bring '" + path.string() + "' to the disk", errno);
}

}  // namespace

Result<void> sync_path(const fs::path& path) {
  const OpenFile file(path);
  if (file.fd() < 0) return {};
  struct stat about {};
  const bool is_folder = ::fstat(file.fd(), &about) == 0 && S_ISDIR(about.st_mode);
  return checked(is_folder ? ::fsync(file.fd()) : ::fdatasync(file.fd()), path);
}

Result<void> sync_disk_of(const fs::path& folder) {
  const OpenFile file(folder);
  if (file.fd() < 0) return {};
  return checked(::syncfs(file.fd()), folder);
}

DiskSync::DiskSync(fs::path folder) : folder_(std::move(folder)) {
  const auto failed = [this](const Error& error) {
    const std::lock_guard lock(mutex_);
    error_ = error;
  };
  thread_ = guarded_thread(
      "writing to the disk", [this] { run(); }, failed);
}

DiskSync::~DiskSync() { (void)finish(); }

void DiskSync::grows(const fs::path& file) {
  const std::lock_guard lock(mutex_);
  growing_.push_back(file);
}

void DiskSync::wrote(const fs::path& file) {
  const std::lock_guard lock(mutex_);
  written_.push_back(file);
}

Result<void> DiskSync::error() const {
  const std::lock_guard lock(mutex_);
  return error_ ? Result<void>(*error_) : Result<void>();
}

Result<void> DiskSync::finish() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
  return error();
}

void DiskSync::run() {
  lower_thread_priority();
  for (bool ends = false; !ends;) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, kSyncEvery, [this] { return ends_; });
      ends = ends_;
    }
    const Result<void> done = sync_all();
    const std::lock_guard lock(mutex_);
    if (!done && !error_) error_ = done.error();
  }
}

/// Called by the thread.
Result<void> DiskSync::sync_all() {
  std::vector<fs::path> growing, written;
  {
    const std::lock_guard lock(mutex_);
    growing = growing_;
    written.swap(written_);
  }
  std::set<fs::path> folders;
  for (const fs::path& path : growing) {
    std::error_code missing;
    const auto bytes = static_cast<std::int64_t>(fs::file_size(path, missing));
    if (missing || synced_bytes_[path] == bytes) continue;
    if (synced_bytes_[path] == 0) folders.insert(path.parent_path());
    MIXRIG_TRY(sync_path(path));
    synced_bytes_[path] = bytes;
  }
  if (written.size() > kMostSingleFiles) return sync_disk_of(folder_);
  for (const fs::path& path : written) {
    MIXRIG_TRY(sync_path(path));
    folders.insert(path.parent_path());
  }
  if (!folders.empty()) folders.insert({folder_, folder_.parent_path()});
  for (const fs::path& path : folders)
    if (!path.empty()) MIXRIG_TRY(sync_path(path));
  return {};
}

}  // namespace mixrig::take
