// SPDX-License-Identifier: Apache-2.0
// A calibration board before all cameras of a rig as a source of captures and as a take.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>

#include "host/capture/capture/capture_source.h"
#include "host/capture/take/take.h"
#include "studio/board/board_studio.h"

namespace mixrig::studio_io {

/// `frames` at the studio's rate. Without BoardOptions::pan_tilt a person takes the board from view
/// to view; with it the board stands, and the source has a head. The fisheye's pictures come at
/// 10 Hz, the first 13.7 ms after frame 1. Cameras are told as designed, not as they are.
/// Errors: kUsage for `frames` outside 1..100000; those of BoardStudio::create.
Result<std::unique_ptr<capture::CaptureSource>> make_board_source(
    const studio::BoardOptions& options, int frames, bool fisheye);

/// Opens a source of board views from the words SEED,RIG,FRAMES,WxH,WxH (the last one is the
/// fisheye's size). Missing words default to 1, kinect2, 600 frames, 1280x1024 and no fisheye.
/// `turns`: with a head. Errors: kUsage.
Result<std::unique_ptr<capture::CaptureSource>> open_board_source(const std::string& words,
                                                                  bool turns);

/// Writes a board that a person moves as a take with truth/truth.json (docs/reference/take.md),
/// whole or not at all. `progress` is called after each frame with the number done. Errors: those
/// of make_board_source; kUsage for a folder that is not a take, kIo; kData where `stop` was set
/// before the last frame.
Result<studio::BoardInfo> write_board_take(const studio::BoardOptions& options, int frames,
                                           const std::filesystem::path& folder,
                                           take::StreamFormat format,
                                           const std::function<void(int)>& progress,
                                           const std::atomic<bool>* stop = nullptr);

}  // namespace mixrig::studio_io
