// SPDX-License-Identifier: Apache-2.0
// Input that all quality levels and peers of a suite share: the same frames, with their truth.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/capture/capture/capture.h"
#include "host/capture/capture/truth.h"
#include "host/run/session/session.h"

namespace mixrig::bench {

/// A frame of the take, decoded before anything is timed.
struct BenchFrame {
  capture::Capture capture;
  capture::Truth truth;
  geometry::Pose world_from_target;
};

/// Setup for one view size, with its learned background.
using SessionPtr = std::unique_ptr<session::Session>;

/// Opens TAKE/scene.toml with the take at `size_px` (empty: that of the take) and learns its
/// background. Errors: those of open_session() and prepare_background().
Result<SessionPtr> open_input(const std::filesystem::path& take, Size size_px, const Clock& clock,
                              const ProgressFn& progress);

/// Reads at most `most` frames after the learned ones, in order. Errors: kUsage for a take without
/// truth or whose lens zooms; those of reading.
Result<std::vector<BenchFrame>> read_frames(const session::Session& session, int most);

/// Plates of at most `most` of the frames that the background is learned from. Errors: those of
/// reading.
Result<std::vector<Image<Rgb8>>> read_empty_plates(const session::Session& session, int most);

}  // namespace mixrig::bench
