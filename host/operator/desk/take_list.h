// SPDX-License-Identifier: Apache-2.0
// The recordings of a folder, and what is noted about each in its recording.toml.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

#include "host/capture/take/take.h"
#include "host/operator/page/operator.h"

namespace mixrig::session {

/// Looks into the folder when it has changed. Thread-safe.
class TakeList {
 public:
  explicit TakeList(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Recordings by the time at which they began to be written, the newest last, at most 1000: whole
  /// ones, and what one that was cut off has left. `running`: a recording that is being written.
  std::vector<page::TakeState> takes(const page::RecordingState& running) const;
  /// Minutes for which `free_gb` last, by the bytes a second of the running recording, or of the
  /// newest one; nullopt: neither is known.
  std::optional<double> minutes_left(const page::RecordingState& running,
                                     std::optional<double> free_gb) const;
  /// Writes into recording.toml, whose other lines stay. Errors: kNotFound, kFormat, kIo.
  Result<void> apply(const page::SetTake& set);
  /// Picture `frame`, from 1, of a whole recording, whose files stay open for the next call. One
  /// call at a time. Errors: kNotFound, kFormat, kData.
  Result<Image<Rgb8>> picture(const std::string& name, int frame);

 private:
  void look() const;

  const std::filesystem::path folder_;
  mutable std::mutex mutex_;  ///< guards the members below
  mutable std::filesystem::file_time_type looked_{};
  mutable std::vector<page::TakeState> takes_;
  std::string played_;  ///< recording that `player_` reads
  std::optional<take::TakeReader> player_;
};

}  // namespace mixrig::session
