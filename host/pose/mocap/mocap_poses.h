// SPDX-License-Identifier: Apache-2.0
// Poses of the target camera from a motion capture that streams NatNet.
#pragma once

#include <memory>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/capture/capture/pose_source.h"
#include "host/pose/mocap/mocap_track.h"

namespace mixrig::pose {

/// Opens poses from a NatNet server. Listens to "HOST[:PORT][,GROUP[:PORT]]" in a thread of its own
/// until it is destroyed, which takes up to 0.1 s. Poses are at Capture::mid_exposure, which must
/// be on the clock of `clock`; it must outlive the source. A failing socket is logged once; every
/// later pose is too old. Errors: kUsage for the address; those of stream::NatNetReceiver::open.
Result<std::unique_ptr<capture::PoseSource>> open_mocap_poses(const std::string& server,
                                                              MocapOptions options,
                                                              const Clock& clock);

}  // namespace mixrig::pose
