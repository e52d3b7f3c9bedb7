// SPDX-License-Identifier: Apache-2.0
// Writes a take with truth and a scene from the virtual studio.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include "host/capture/take/take.h"
#include "studio/studio.h"

namespace mixrig::studio_io {

/// Cameras, rig, units and noise of a studio as a take tells them.
take::TakeInfo studio_take_info(const studio::StudioInfo& info);

/// Swaps the pictures of a rendered frame into `to`; `from` gets the old memory.
void swap_into(const studio::StudioInfo& info, studio::Frame& from, capture::Capture& to);
void swap_into(studio::Truth& from, capture::Truth& to);

/// Writes scene.toml and models/ for a studio: its object, lamps, camera poses from the take and
/// a background learned from the empty frames. Errors: kIo.
Result<void> write_scene(const studio::StudioInfo& info, const std::filesystem::path& folder);

/// Renders a whole take with truth, and the scene, into `folder`: whole or not at all.
/// With StudioOptions::fisheye the take has that stream and truth/fisheye.tum.
/// `progress` is called after each frame with the number done.
/// Errors: kUsage for options out of range or a folder that is not a take, kIo, kUnsupported; kData
/// where `stop` was set before the last frame.
Result<studio::StudioInfo> write_studio_take(const studio::StudioOptions& options,
                                             const std::filesystem::path& folder,
                                             take::StreamFormat format,
                                             const std::function<void(int)>& progress,
                                             const std::atomic<bool>* stop = nullptr);

}  // namespace mixrig::studio_io
