// SPDX-License-Identifier: Apache-2.0
// The captures of a run, in the order in which they are composited.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/work_gate.h"
#include "host/capture/capture/capture_reader.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Reads ahead in a thread of its own, and holds captures until those have come that their pose
/// waits for. For the compositing thread.
class CaptureFeed {
 public:
  /// `session`, whose poses are prepared, and the gate outlive it.
  CaptureFeed(const Session& session, int first, int last, bool with_truth, WorkGate* gate)
      : session_(session), reader_(*session.source, first, last, with_truth, gate) {}

  /// The next capture, once those within the latency of its pose have come too; empty at the end.
  /// Errors: those of the source.
  Result<std::optional<capture::CaptureItem>> next();
  /// Puts back the first one, with which the run was warmed up; of a live run what was exposed
  /// before `now` was exposed too early.
  void give_back(capture::CaptureItem item, HostTime now);
  /// As next(), without what is late since the run was not ready, but for the last that there is.
  Result<std::optional<capture::CaptureItem>> next_fresh();

  /// Captures that next_fresh() left out.
  std::uint64_t late() const { return late_; }
  /// Captures of a live source that nobody took in time.
  std::uint64_t dropped() const { return reader_.dropped(); }

 private:
  const Session& session_;
  capture::CaptureReader reader_;
  std::vector<capture::CaptureItem> held_;  ///< that were read ahead, the oldest first
  bool drained_ = false;                    ///< the reader has no more
  std::optional<HostTime> ready_;           ///< when the first frame of a live run could be made
  std::uint64_t late_ = 0;
};

}  // namespace mixrig::session
