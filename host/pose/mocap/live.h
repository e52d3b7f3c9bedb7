// SPDX-License-Identifier: Apache-2.0
// Frames of a motion capture while it runs.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "host/pose/mocap/natnet_receiver.h"

namespace mixrig::mocap {

struct LiveOptions {
  std::optional<double> duration_s;  ///< from the first frame on; absent: until stop or silence
  std::size_t frames = 0;            ///< most of them; 0: any number
  Duration silence = std::chrono::seconds(5);  ///< after which a stream has ended
};

/// Frames until `stop`, their number, the end of the duration, or silence. Errors: kDevice where
/// no frame came; those of the receiver.
Result<std::vector<stream::NatNetFrame>> receive_frames(stream::NatNetReceiver& receiver,
                                                        const LiveOptions& options,
                                                        const std::atomic<bool>& stop,
                                                        const Clock& clock);

}  // namespace mixrig::mocap
