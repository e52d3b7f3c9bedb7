// SPDX-License-Identifier: Apache-2.0
// Records composites of a run while it goes on, from a start to a stop.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "hal/base/partial_path.h"
#include "hal/base/pool.h"
#include "host/operator/page/operator.h"
#include "host/output/files/files_sink.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Each recording is a folder FOLDER/NAME, whole or not there: composite/ (a take, lossless video),
/// frames.csv, recording.toml with the notes. A thread of its own, of low priority, encodes
/// and writes; up to 256 MiB of frames wait for it, so that a machine that is busy for some seconds
/// loses none. A fault of a recording ends it and not the run; it is told in state(). Any threads.
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
  /// Returns when all frames are written. Errors: kData where none runs; kIo.
  Result<void> stop();
  /// A frame, while one runs: copies what is recorded, about a millisecond. Frames that find no
  /// room, and those that are not given, by their numbers, count as lost. One thread.
  void write(const output::CompositePtr& composite);
  /// These two never wait for a frame that is being written.
  bool is_on() const { return on_; }
  page::RecordingState state() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::string free_name() const;
  Result<void> open(const std::string& name);
  output::CompositePtr copy(const output::Composite& composite);
  void run();
  void join();
  Result<void> finish();
  void give_up(const Error& error);
  template <typename Change>
  void change_state(Change&& change);

  const Session& session_;
  const std::filesystem::path folder_;
  std::mutex mutex_;  ///< one start or stop at a time; guards path_ and files_ while no thread runs
  std::optional<PartialPath> path_;
  std::unique_ptr<output::FilesSink> files_;  ///< of the thread while it runs; null: no recording
  std::thread thread_;
  std::atomic<bool> on_ = false;
  Pool<output::Composite> copies_;

  std::mutex queue_mutex_;  ///< guards what follows
  std::condition_variable wake_;
  std::deque<output::CompositePtr> queue_;
  std::size_t most_waiting_ = 0;
  bool ends_ = true;
  int last_number_ = 0;  ///< of the run's frames; 0: none yet
  double first_s_ = 0;

  mutable std::mutex state_mutex_;  ///< guards state_; the last to be taken
  page::RecordingState state_;
};

}  // namespace mixrig::session
