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

/// Errors: kFormat for frames that the source lacks.
Result<void> check_empty_frames(const capture::SourceInfo& info, FrameRange range);

/// Warps frames `range` of a source into the view of `setup` and learns the empty room from them.
/// Where `poses` (null: the camera stands still) says that the camera moved between the frames, or
/// the lens did, they are drawn in one wider view first; a live source cannot be read twice for
/// this. Errors: kFormat for frames that the source lacks; kData where the camera of a live source
/// moved, or turned too far for one view; those of reading, composing and learning.
Result<model::StaticBackground> learn_background(capture::CaptureSource& source,
                                                 const render::CompositorSetup& setup,
                                                 FrameRange range, BackendChoice backend,
                                                 const ProgressFn& progress,
                                                 capture::PoseSource* poses = nullptr);

/// What a frame shows, and from where.
struct PosedView {
  geometry::Pinhole camera;
  geometry::Pose world_from_camera;
};
/// An ideal camera that sees all of what `views` (one or more) see, at the resolution of the finest
/// one, and its pose: the mean position, along the mean direction. Pure.
/// Errors: kData where the poses turn too far for one pinhole.
struct WideView {
  geometry::Pinhole camera;
  geometry::Pose world_from_camera;
};
Result<WideView> view_of_all(std::span<const PosedView> views);

}  // namespace mixrig::session
