// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/live.h"

namespace mixrig::mocap {

Result<std::vector<stream::NatNetFrame>> receive_frames(stream::NatNetReceiver& receiver,
                                                        const LiveOptions& options,
                                                        const std::atomic<bool>& stop,
                                                        const Clock& clock) {
  constexpr Duration kLook = std::chrono::milliseconds(100);  // how often `stop` is checked
  std::vector<stream::NatNetFrame> frames;
  HostTime heard = clock.now();
  std::optional<HostTime> first;
  while (!stop) {
    MIXRIG_ASSIGN(auto frame, receiver.next(kLook));
    const HostTime now = clock.now();
    if (frame) {
      heard = now;
      if (!first) first = now;
      frames.push_back(*std::move(frame));
    }
    if (now - heard >= options.silence) break;
    if (options.frames > 0 && frames.size() >= options.frames) break;
    if (first && options.duration_s && seconds(now - *first) >= *options.duration_s) break;
  }
  if (frames.empty())
    return Error{ErrorCode::kDevice,
                 "no frames came: does the motion capture stream NatNet, to this machine or to the "
                 "group that is named, and does a firewall let UDP in?"};
  return frames;
}

}  // namespace mixrig::mocap
