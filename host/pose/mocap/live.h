// SPDX-License-Identifier: Apache-2.0
// Receives frames of a motion capture while it runs.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "host/pose/mocap/natnet_receiver.h"

namespace mixrig::mocap {

struct LiveOptions {
  /// Counted from the first frame; absent: until stop or silence.
  std::optional<double> duration_s;
  std::size_t frames = 0;  ///< largest number of frames; 0: no limit
  /// Time without frames after which the stream has ended.
  Duration silence = std::chrono::seconds(5);
};

/// Receives frames until `stop`, their number, the end of the duration, or silence. Errors: kDevice
/// if no frame came; those of the receiver.
Result<std::vector<stream::NatNetFrame>> receive_frames(stream::NatNetReceiver& receiver,
                                                        const LiveOptions& options,
                                                        const std::atomic<bool>& stop,
                                                        const Clock& clock);

}  // namespace mixrig::mocap
