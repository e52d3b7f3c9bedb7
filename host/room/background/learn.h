// SPDX-License-Identifier: Apache-2.0
// Learns the empty room from frames of a source.
#pragma once

#include <span>

#include "hal/base/frame_range.h"
#include "hal/base/progress.h"
#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/capture/pose_source.h"
#include "host/render/backend/backend.h"
#include "host/render/contract/compositor.h"
#include "host/room/background/static_background.h"

namespace mixrig::session {

/// Checks that the source has the frames of `range`. Errors: kFormat if not.
Result<void> check_empty_frames(const capture::SourceInfo& info, FrameRange range);

/// Learns the empty room from frames `range` of a source, warped into the view of `setup`. If
/// camera (by `poses`; null: it stands still) or lens moved between the frames, they are first
/// drawn in one wider view; a live source cannot be read twice for this. Errors: kFormat for frames
/// that the source lacks; kData if the camera of a live source moved, or a camera turned too far
/// for one view; those of reading, composing and learning.
Result<model::StaticBackground> learn_background(capture::CaptureSource& source,
                                                 const render::CompositorSetup& setup,
                                                 FrameRange range, BackendChoice backend,
                                                 const ProgressFn& progress,
                                                 capture::PoseSource* poses = nullptr);

/// Pinhole and pose of a frame.
struct PosedView {
  geometry::Pinhole camera;
  geometry::Pose world_from_camera;
};
/// An ideal camera that sees everything that `views` (one or more) see, at the resolution of the
/// finest one, with its pose at their mean position along their mean direction. Pure. Errors: kData
/// if the poses turn too far for one pinhole.
struct WideView {
  geometry::Pinhole camera;
  geometry::Pose world_from_camera;
};
Result<WideView> view_of_all(std::span<const PosedView> views);

}  // namespace mixrig::session
