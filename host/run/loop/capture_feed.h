// SPDX-License-Identifier: Apache-2.0
// Delivers the captures of a run in the order of compositing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/work_gate.h"
#include "host/capture/capture/capture_reader.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Reads ahead in its own thread, and holds each capture until the captures that its pose waits for
/// have come. For the compositing thread.
class CaptureFeed {
 public:
  /// `session`, whose poses must be prepared, and `gate` must outlive it.
  CaptureFeed(const Session& session, int first, int last, bool with_truth, WorkGate* gate)
      : session_(session), reader_(*session.source, first, last, with_truth, gate) {}

  /// The next capture, once the captures within its pose's latency have come too; empty at the end.
  /// Errors: those of the source.
  Result<std::optional<capture::CaptureItem>> next();
  /// Puts back the first capture, with which the run was warmed up. In a live run, captures exposed
  /// more than 1.5 frame periods before `now` then count as late.
  void give_back(capture::CaptureItem item, HostTime now);
  /// Like next(), but the first call after give_back() skips late captures, save the last there is.
  Result<std::optional<capture::CaptureItem>> next_fresh();

  /// Number of captures that next_fresh() skipped.
  std::uint64_t late() const { return late_; }
  /// Number of captures of a live source that were not taken in time.
  std::uint64_t dropped() const { return reader_.dropped(); }

 private:
  const Session& session_;
  capture::CaptureReader reader_;
  std::vector<capture::CaptureItem> held_;  ///< captures read ahead, the oldest first
  bool drained_ = false;                    ///< the reader has no more captures
  std::optional<HostTime> ready_;           ///< live: time at which the first frame could be made
  std::uint64_t late_ = 0;
};

}  // namespace mixrig::session
