// SPDX-License-Identifier: Apache-2.0
// The takes of one recording: one, or segments that follow each other.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "host/capture/live/session/record.h"
#include "host/capture/live/session/take_recorder.h"

namespace mixrig::live {

/// Writes sets into the take RecordOptions::out, or into segments in that folder. An earlier
/// segment is completed, and the oldest are deleted where asked, in a thread of its own. Not
/// thread-safe; the arguments of the constructor must outlive it.
class SegmentRecorder {
 public:
  SegmentRecorder(const RigConfig& config, const Devices& devices, const RecordOptions& options,
                  take::TakeInfo info, LensStream* lens);
  ~SegmentRecorder();
  SegmentRecorder(const SegmentRecorder&) = delete;
  SegmentRecorder& operator=(const SegmentRecorder&) = delete;

  /// Begins the first take. Errors: kUsage for a folder that holds other things; kIo, also where
  /// the disk has less than RecordOptions::least_free_bytes, or the folder its share already.
  Result<void> open();
  /// Writes a set, into the next segment where one is due; false for a set without readable colour
  /// and depth. Errors: those of TakeWriter, also of the take before.
  Result<bool> write(const LiveSet& set);
  /// Why the recording must end now; empty: it need not. Where the oldest segments may be deleted
  /// it begins the next one instead, whose thread does that.
  Result<std::string> ends_by_space();
  /// Completes the last take, and waits for the one before. Errors: those of TakeWriter::finish().
  Result<void> finish();
  int frames() const { return earlier_ + (recorder_ ? recorder_->frames() : 0); }
  int takes() const { return takes_; }
  int deleted() const { return deleted_; }

 private:
  Result<std::unique_ptr<TakeRecorder>> next_recorder();
  Result<void> turn();
  Result<void> join();
  void make_space(std::uint64_t wanted_bytes);
  std::uint64_t free_bytes() const;
  bool is_over_share(std::uint64_t further_bytes) const;

  const RigConfig& config_;
  const Devices& devices_;
  const RecordOptions& options_;
  const Segments& segments_;
  const take::TakeInfo info_;
  LensStream* const lens_;
  std::unique_ptr<TakeRecorder> recorder_;
  int earlier_ = 0;  ///< frames of the takes before
  int takes_ = 0;
  bool is_full_ = false;                        ///< the take has the bytes of a segment
  std::thread closing_;                         ///< completes the take before
  std::atomic<bool> closes_ = false;            ///< it is at work
  std::atomic<bool> failed_ = false;            ///< it has set error_
  std::optional<Error> error_;                  ///< read after closing_ was joined
  std::atomic<std::uint64_t> whole_bytes_ = 0;  ///< of the whole segments in the folder
  std::atomic<int> deleted_ = 0;
};

}  // namespace mixrig::live
