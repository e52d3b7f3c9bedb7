// SPDX-License-Identifier: Apache-2.0
// Brings what a recording has written to the disk, every second.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::take {

/// Writes to the disk in a thread of its own, so that nobody who writes frames waits for it. A
/// power cut then costs at most what was written since the last second. Thread-safe.
class DiskSync {
 public:
  /// `folder` is the folder that is recorded into.
  explicit DiskSync(std::filesystem::path folder);
  ~DiskSync();
  DiskSync(const DiskSync&) = delete;
  DiskSync& operator=(const DiskSync&) = delete;

  /// A file that grows until the end.
  void grows(const std::filesystem::path& file);
  /// A file that was written whole.
  void wrote(const std::filesystem::path& file);
  /// What the disk has refused. Errors: kIo.
  Result<void> error() const;
  /// Brings all to the disk and ends the thread. Errors: kIo.
  Result<void> finish();

 private:
  void run();
  Result<void> sync_all();

  const std::filesystem::path folder_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable wake_;
  std::vector<std::filesystem::path> growing_, written_;
  std::optional<Error> error_;
  bool ends_ = false;
  std::map<std::filesystem::path, std::int64_t> synced_bytes_;  ///< of growing files; the thread's
  std::thread thread_;
};

/// Brings one file or folder to the disk. Errors: kIo; none where it is not there.
Result<void> sync_path(const std::filesystem::path& path);
/// Brings all of the disk that holds `folder` up to date. Errors: kIo.
Result<void> sync_disk_of(const std::filesystem::path& folder);

}  // namespace mixrig::take
