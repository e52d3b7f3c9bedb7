// SPDX-License-Identifier: Apache-2.0
// Zoom and focus of a rig's lens by FreeD: freed:[HOST:]PORT[,CAMERA].
#pragma once

#include <memory>

#include "extras/broadcast/packets/freed_receiver.h"
#include "host/capture/live/rig/device_kind.h"

namespace mixrig::stream {

/// Kind of device: encoders of a lens without a camera.
live::DeviceKind freed_lens_kind();

std::unique_ptr<live::LensReceiver> make_freed_lens(FreeDReceiver receiver);

}  // namespace mixrig::stream
