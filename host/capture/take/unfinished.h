// SPDX-License-Identifier: Apache-2.0
// Takes whose writing was cut off: how many frames are whole. Private to this module.
#pragma once

#include <filesystem>
#include <string>

#include "host/capture/take/manifest.h"

namespace mixrig::take {

/// What is whole of a take that has no end.
struct WholePart {
  int frames = 0;
  double cut_s = 0;      ///< between its last whole frame and the last one that is known of
  bool is_open = false;  ///< a program is writing it now
};

/// Sets the counts of the manifest to what is whole in its files. Errors: kData where no frame is;
/// kIo; kFormat of a table.
Result<WholePart> count_whole(Manifest& manifest);
/// "took 345 frames, the last 0.4 s were cut off", after the take's name.
std::string text_of(const WholePart& part, const std::string& name);

/// Ends streams and tables of the take in `folder` where they are whole and writes its manifest
/// with the frames that all have. Errors: those of count_whole().
Result<WholePart> make_whole(const std::filesystem::path& folder);

/// Holds the folder of a take that is being written, until it is destroyed or the process ends.
class FolderLock {
 public:
  FolderLock() = default;
  /// Does not wait: see holds().
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  ~FolderLock();
  /// False where another one holds the folder. A disk that knows no locks is held by nobody.
  bool holds() const { return holds_; }
  /// Whether another one holds the folder; it is not held afterwards.
  static bool is_held(const std::filesystem::path& folder);

 private:
  int fd_ = -1;
  bool holds_ = true;
};

}  // namespace mixrig::take
