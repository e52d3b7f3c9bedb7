// SPDX-License-Identifier: Apache-2.0
// A take that is complete on disk after every appended view.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "host/capture/capture/bracket.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

/// Writes numbered PNG pictures, pan_tilt.csv and, if frames have a fisheye's picture, its stream
/// with fisheye.csv and the frames' times in ticks.csv. When a take is continued its times go on a
/// second after its last frame. The manifest, which counts the frames, is replaced last: however
/// the process or the power ends, the folder is the take as it was after the last append(). Before
/// the first append() it is not a take. Not thread-safe.
class GrowingTake {
 public:
  /// Continues the take in `folder`, or begins one if there is no take.toml; for `info` see
  /// TakeWriter. Errors: kIo, kNotFound (calibration); those of TakeReader::open for a take that
  /// cannot be read.
  static Result<GrowingTake> open(const std::filesystem::path& folder, const TakeInfo& info);
  GrowingTake(GrowingTake&&) noexcept;
  GrowingTake& operator=(GrowingTake&&) noexcept;
  ~GrowingTake();

  int frames() const;
  /// Appends all frames or none, all with the angles `at`; a fisheye's picture is stored once, with
  /// the first frame that has it; `bracket` are plates of the same view (bracket_files.h). Errors:
  /// kIo; kData if amplitudes are missing that other frames have.
  Result<void> append(std::span<const capture::Capture> frames, device::PanTiltAngles at,
                      std::span<const capture::BracketPlate> bracket = {});

 private:
  struct State;
  explicit GrowingTake(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::take
