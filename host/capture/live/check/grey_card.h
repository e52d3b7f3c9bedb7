// SPDX-License-Identifier: Apache-2.0
// The test of colour on a grey card in front of a running camera.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "host/capture/capture/grey_card.h"
#include "host/capture/live/check/diagnose.h"
#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

/// Returns the camera's next frame; null if none came in a short time. Errors: the camera has
/// ended.
using NextFrame = std::function<Result<device::FramePtr>()>;

/// Checks "card" (light enough, not too much), "transfer" (where the exposure can be set) and
/// "grey". Without `area` it uses the middle fifth of the picture. Never fails: a check that cannot
/// be judged is failed or a warning. Controls that rig.toml does not fix are held at their present
/// values from then on; the exposure is halved twice and put back.
std::vector<Check> check_card(const CameraConfig& config, device::Camera& camera,
                              const std::optional<capture::CardArea>& area, const NextFrame& next,
                              Clock& clock);

}  // namespace mixrig::live
