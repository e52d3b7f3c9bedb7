// SPDX-License-Identifier: Apache-2.0
// Writes the sets of a live session into one take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/capture/live/session/lens_stream.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/session/live_session.h"
#include "host/capture/take/take.h"

namespace mixrig::live {

/// One take that record() writes. Not thread-safe; `config`, `devices` and `lens` must outlive it.
class TakeRecorder {
 public:
  /// `lens`: null for a rig without [lens].
  TakeRecorder(const RigConfig& config, const Devices& devices, take::TakeWriter writer,
               LensStream* lens);

  /// Begins the tables, and reserves disk space that finish() frees: a take on a full disk can
  /// still be finished. Errors: kIo.
  Result<void> begin();
  /// Writes a set; false for one without readable colour and depth. Errors: those of TakeWriter.
  Result<bool> write(const LiveSet& set);
  Result<void> finish();
  int frames() const { return number_; }
  HostTime first() const { return first_; }  ///< mid-exposure of the first frame
  const std::filesystem::path& folder() const { return writer_.staging(); }

 private:
  Result<void> write_others(const LiveSet& set);
  Result<void> write_rows(const LiveSet& set);

  struct Extra {
    capture::ColorDecoder decoder;
    Image<Rgb8> picture;
    int count = 0;
    std::uint64_t last = 0;
  };
  const RigConfig& config_;
  const Devices& devices_;
  LensStream* const lens_;
  SetDecoder decoder_;
  take::TakeWriter writer_;
  capture::Capture frame_;
  std::vector<Extra> extra_;
  std::string rows_;  ///< of a frame, reused
  std::filesystem::path reserve_;
  HostTime first_{};
  int number_ = 0;
};

}  // namespace mixrig::live
