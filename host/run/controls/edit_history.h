// SPDX-License-Identifier: Apache-2.0
// Changes of files that can be taken back and made again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::session {

/// One change of a file.
struct Edit {
  std::string what;  ///< "move crate"
  std::filesystem::path file;
  std::string before, after;                       ///< text of the file
  std::function<Result<void>()> on_undo, on_redo;  ///< what else follows the file; empty: nothing
};

/// The last 100 edits. Edits of one name that follow each other within a second are one: a fader,
/// or a key that is held. A file that another program has changed meanwhile is never overwritten.
/// Thread-safe.
class EditHistory {
 public:
  /// `clock` must outlive it.
  explicit EditHistory(const Clock& clock) : clock_(clock) {}

  /// Notes an edit that was made. What was taken back before cannot be made again after it.
  void add(Edit edit);
  /// Writes the text before the last edit, or after the one that was taken back last. Errors: kData
  /// if there is none, or the file is not as the history left it; those of writing.
  Result<void> undo();
  Result<void> redo();
  /// Name of the edit that undo() or redo() is about; empty: none.
  std::string next_undo() const;
  std::string next_redo() const;

 private:
  const Clock& clock_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::vector<Edit> edits_;
  std::size_t done_ = 0;  ///< edits [0, done_) are in force
  HostTime last_{};       ///< of the last add()
  bool joins_ = false;    ///< the last thing that happened was an add()
};

}  // namespace mixrig::session
