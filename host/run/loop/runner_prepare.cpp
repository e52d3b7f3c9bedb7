// SPDX-License-Identifier: Apache-2.0
// What a run does before its first frame.
#include <utility>

#include "host/run/loop/runner.h"

namespace mixrig::session {

Result<void> Runner::prepare(FrameRange range, const ProgressFn& progress) {
  std::optional<std::filesystem::path> folder;
  if (options_.out) {
    MIXRIG_ASSIGN(folder_, make_partial_folder(*options_.out, kReportName));
    folder = folder_->path();
  }
  MIXRIG_TRY(sinks_.open(range, folder, std::move(parts_.sinks), parts_.extras));
  // The background of a camera that moves is learned by its poses; one on the floor has its pose
  // from the background.
  const bool on_floor = session_.scene.pose_source == scene::PoseSource::kFloor;
  if (!on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_TRY(prepare_background(session_, progress));
  if (on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_ASSIGN(quality_, follow_budget(session_, range.first, clock_));
  MIXRIG_TRY(sinks_.open_streams());
  poses_.open();
  // A live source may drop captures: it is read until enough were composited.
  feed_.emplace(session_, range.first, live() ? capture::kEndless : range.second, reads_truth(),
                gate());
  MIXRIG_ASSIGN(auto first, feed_->next());
  pose::FramePose known;
  if (first) known = pose_of_first(*first->capture);
  MIXRIG_TRY(open_compositor());
  if (!session_.setup.background.depth_m.empty() && !session_.setup.lens_moves)
    seen_through_.emplace(session_.setup);
  if (options_.baselines) MIXRIG_TRY(open_baselines());
  return first ? warm_up(*std::move(first), known) : Result<void>();
}

/// Pose of the first frame. The compositor of a still camera is made for it.
pose::FramePose Runner::pose_of_first(const capture::Capture& capture) {
  pose::FramePoses poses(*session_.poses, frame_pose_options(session_.scene));
  pose::FramePose known = poses.next(capture);
  render::CompositorSetup& setup = session_.setup;
  const bool still = !setup.background.depth_m.empty() && !setup.lens_moves;
  if (still && known.camera.ok()) setup.first_pose = known.camera.world_from_target;
  return known;
}

Result<void> Runner::open_compositor() {
  session_.setup.may_hide_objects = session_.poses->info().moves;
  MIXRIG_TRY(compositor_.open(sinks_.mover(), gate()));
  if (parts_.orders != nullptr)
    parts_.orders->tell(
        [&](output::RunState& run) { run.can_record = sinks_.has_files() || run.records_takes; });
  return {};
}

Result<void> Runner::open_baselines() {
  if (!judges())
    return Error{ErrorCode::kUsage, session_.source->info().name +
                                        " has no truth to hold baselines against: leave out "
                                        "--baselines, or use a take of mixrig studio"};
  if (session_.setup.lens_moves)
    return Error{ErrorCode::kUsage, session_.source->info().name +
                                        " has a lens that zooms, which the baselines do not "
                                        "follow: leave out --baselines"};
  return baselines_.emplace().open(session_.setup);
}

/// The first frame costs much more than others: shaders are built, memory is touched, and it is
/// found what the room hides of the lamps. The first capture is composited once for that, before
/// times are taken. What was exposed meanwhile in a live run is late, so that it is not composited
/// (CaptureFeed::next_fresh).
Result<void> Runner::warm_up(capture::CaptureItem item, const pose::FramePose& known) {
  const capture::Capture& capture = *item.capture;
  if (known.camera.ok()) {  // else the room's place is not known
    const auto composite = composites_.take();
    composite->capture = item.capture;
    composite->view = frame_view(session_.setup, capture);
    composite->world_from_target = known.camera.world_from_target;
    composite->world_from_object.clear();
    composite->motion.reset();
    const render::OutputMask images = wanted(sinks_.wanted(capture.number).all);
    MIXRIG_TRY(compositor_.compose(*composite, images, composite->images));
    swap_inspection(composite->images);
  }
  feed_->give_back(std::move(item), clock_.now());
  return {};
}

}  // namespace mixrig::session
