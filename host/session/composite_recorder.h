// SPDX-License-Identifier: Apache-2.0
// Records composites of a run while it goes on, from a start to a stop.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hal/base/partial_path.h"
#include "host/output/files_sink.h"
#include "host/page/operator.h"
#include "host/session/session.h"

namespace mixrig::session {

/// Each recording is a folder FOLDER/NAME, whole or not there: composite/ (a take, lossless video),
/// frames.csv, recording.toml with the notes. A fault of a recording ends it and not the run; it is
/// told in state(). Any threads.
class CompositeRecorder {
 public:
  /// `session` outlives it.
  CompositeRecorder(const Session& session, std::filesystem::path folder);
  ~CompositeRecorder();
  CompositeRecorder(const CompositeRecorder&) = delete;
  CompositeRecorder& operator=(const CompositeRecorder&) = delete;

  /// An empty name: the first of "take 1", "take 2", ... that is free. Errors: kUsage where the
  /// name is taken, kData while another one runs; kIo.
  Result<void> start(const std::string& name, const std::string& notes);
  /// Errors: kData where none runs; kIo.
  Result<void> stop();
  /// A frame, while one runs. Frames that are not given, by their numbers, count as lost.
  void write(const output::CompositePtr& composite);
  /// These two never wait for a frame that is being written.
  bool is_on() const { return on_; }
  page::RecordingState state() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::string free_name() const;
  Result<void> finish();
  void give_up(const Error& error);
  template <typename Change>
  void change_state(Change&& change);

  const Session& session_;
  const std::filesystem::path folder_;
  std::atomic<bool> on_ = false;
  std::mutex
      mutex_;  ///< guards the files and what is counted in them; held while a frame is written
  std::optional<PartialPath> path_;
  std::unique_ptr<output::FilesSink> files_;  ///< null: none runs
  int last_number_ = 0;                       ///< of the run's frames; 0: none yet
  double first_s_ = 0;
  mutable std::mutex state_mutex_;  ///< guards state_; the last to be taken
  page::RecordingState state_;
};

}  // namespace mixrig::session
