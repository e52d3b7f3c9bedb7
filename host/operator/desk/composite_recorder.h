// SPDX-License-Identifier: Apache-2.0
// Records composites during a run, from a start to a stop.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "hal/base/partial_path.h"
#include "hal/base/pool.h"
#include "host/operator/desk/desk_state.h"
#include "host/operator/page/operator.h"
#include "host/output/files/files_sink.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Each recording is a folder FOLDER/NAME, written whole or not at all: composite/ (a take,
/// lossless video), frames.csv, recording.toml with the notes. A low-priority thread encodes and
/// writes; up to 256 MiB of frames wait for it, so that a machine that is busy for some seconds
/// loses none. An error or a disk that is almost full ends the recording, not the run, and is
/// reported by state(); what was written before is completed or, where that fails, stays as
/// NAME.partial. Thread-safe.
class CompositeRecorder {
 public:
  /// Free space of a folder's disk in GB; nullopt: not known.
  using FreeSpace = std::function<std::optional<double>(const std::filesystem::path&)>;

  /// `session` must outlive it. `segment_s`: see output::OutputOptions.
  CompositeRecorder(const Session& session, std::filesystem::path folder,
                    FreeSpace free_space = free_gb, double segment_s = 0);
  ~CompositeRecorder();
  CompositeRecorder(const CompositeRecorder&) = delete;
  CompositeRecorder& operator=(const CompositeRecorder&) = delete;

  /// Starts a recording. An empty name: the first free one of "take 1", "take 2", ... Errors:
  /// kUsage if the name is taken, kData while a recording runs; kIo, also for a disk that is almost
  /// full.
  Result<void> start(const std::string& name, const std::string& notes);
  /// Ends the recording; returns when all frames are written. Errors: kData if none runs; kIo.
  Result<void> stop();
  /// Records a copy of a frame, if a recording runs; takes about a millisecond. Frames that find no
  /// memory, and frame numbers that are skipped, count as lost. For one thread.
  void write(const output::CompositePtr& composite);
  /// is_on() and state() never wait for a frame being written.
  bool is_on() const { return on_; }
  page::RecordingState state() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::string free_name() const;
  Result<void> open(const std::string& name);
  output::CompositePtr copy(const output::Composite& composite);
  Result<void> run();
  void join();
  Result<void> check_disk() const;
  Result<void> complete(const std::string& ended);
  void end_early(const Error& error);
  Error keep_partial(const Error& error);
  void give_up(const Error& error);
  template <typename Change>
  void change_state(Change&& change);

  const Session& session_;
  const std::filesystem::path folder_;
  const FreeSpace free_space_;
  const double segment_s_;
  std::mutex mutex_;  ///< one start or stop at a time; guards path_ and files_ while no thread runs
  std::optional<PartialPath> path_;
  /// Used by the thread while it runs; null: no recording.
  std::unique_ptr<output::FilesSink> files_;
  std::thread thread_;
  std::atomic<bool> on_ = false;
  Pool<output::Composite> copies_;

  std::mutex queue_mutex_;  ///< guards the members below
  std::condition_variable wake_;
  std::deque<output::CompositePtr> queue_;
  std::size_t most_waiting_ = 0;
  bool ends_ = true;
  int last_number_ = 0;  ///< number of the last frame; 0: none yet
  double first_s_ = 0;

  mutable std::mutex state_mutex_;  ///< guards state_; the last to be taken
  page::RecordingState state_;
};

}  // namespace mixrig::session
