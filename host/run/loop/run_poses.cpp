// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/run_poses.h"

#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/run/loop/contact_points.h"
#include "host/run/session/camera_pose.h"
#include "host/scene/pose_kind.h"

namespace mixrig::session {
namespace {

/// Whether the poses of the scene can be held against true ones: both are of one world.
bool has_true_poses(const Session& session) {
  const bool from_elsewhere =
      scene::kind_of(session.scene.pose_source).world == scene::PoseWorld::kOfScene ||
      (session.scene.pose_source == scene::PoseSource::kRecorded &&
       !session.scene.camera.trajectory.empty());
  return from_elsewhere && session.source->info().true_poses;
}

/// Exposure time of a plate by the scene, else by the source, for the motion blur of virtual
/// objects and to find sharp plates; 0: not needed, or unknown.
double plate_exposure_s(const Session& session) {
  const scene::LookSettings& look = session.scene.look;
  const bool asked = look.motion || session.setup.look.measures();
  if (!asked || !session.poses->info().moves) return 0;
  const double known_s =
      look.exposure_ms > 0 ? 1e-3 * look.exposure_ms : session.source->info().exposure_s;
  if (!(known_s > 0) && look.motion)
    log_warning("session", session.scene.path.string() +
                               ": look.motion: how long a plate is exposed is not known, so that "
                               "nothing is blurred: give look.exposure_ms");
  return known_s;
}

}  // namespace

void RunPoses::open() {
  poses_.emplace(*session_.poses, frame_pose_options(session_.scene));
  slip_.emplace(contact_points(session_.setup.objects), session_.setup.view);
  lens_.emplace(session_.setup,
                session_.background && session_.rooms.empty() ? &*session_.background : nullptr);
  if (has_true_poses(session_)) error_.emplace();
  motion_ = PlateMotion(plate_exposure_s(session_));
}

void RunPoses::set(output::Composite& composite) {
  const pose::FramePose known = poses_->next(*composite.capture);
  composite.pose = known.camera;
  composite.world_from_target = known.camera.world_from_target;
  composite.objects_shown = known.objects_shown;
  composite.motion = motion_.next(known.camera, composite.capture->time_s);
  if (known.camera.ok()) {
    age_ms_.add(1e3 * known.camera.age_s);
    if (error_) error_->add(composite.world_from_target, composite.capture->world_from_target);
    return;
  }
  if (error_) error_->skip();
  if (std::exchange(warned_lost_, true)) return;
  log_warning("session", fmt::format("frame {}: the camera's pose is lost ({}): virtual objects "
                                     "are {}; frames.csv and the report say where",
                                     composite.capture->number, capture::name(known.camera.loss),
                                     known.objects_shown ? "frozen" : "hidden"));
}

void RunPoses::watch(output::Composite& composite, bool judges, const capture::Truth* truth) {
  watch_slip(composite, judges, truth);
  lens_->add(*composite.capture, composite.world_from_target);
  watch_camera(composite.world_from_target);
}

/// Measures slip. It compares with true poses only where the scene's poses are in their world,
/// which those of "floor" and "identity" are not.
void RunPoses::watch_slip(output::Composite& composite, bool judges, const capture::Truth* truth) {
  composite.slip_px = composite.slip_sigma_px = std::nullopt;
  if (!composite.objects_shown) return;
  const capture::Capture& capture = *composite.capture;
  const bool known =
      judges && capture.pose_origin == capture::PoseOrigin::kRecorded &&
      scene::kind_of(session_.scene.pose_source).world != scene::PoseWorld::kOfCamera;
  capture::CameraPose used = composite.pose;
  used.world_from_target = world_from_pupil(used.world_from_target, capture);
  std::optional<geometry::Pose> true_pose;
  if (known) true_pose = capture.world_from_target;
  geometry::Pinhole true_view = session_.setup.view;
  if (known && truth != nullptr && truth->lens) {
    true_pose = geometry::at_pupil(*true_pose, truth->lens->pupil_shift_m);
    true_view = resized(truth->lens->view, true_view.size_px);
  }
  const FrameSlip slip =
      slip_->add(used, true_pose, frame_view(session_.setup, capture), true_view);
  composite.slip_px = slip.measured_px;
  composite.slip_sigma_px = slip.sigma_px;
}

void RunPoses::watch_camera(const geometry::Pose& world_from_target) {
  if (!first_pose_) first_pose_ = world_from_target;
  if (warned_ || !session_.background || !session_.setup.background_models.empty() ||
      !capture::moved(*first_pose_, world_from_target))
    return;
  warned_ = true;
  log_warning("session",
              "the camera moves, the background is of a static camera: people are keyed "
              "wrongly away from the first pose");
}

PoseReport RunPoses::report() const {
  PoseReport report;
  report.source = session_.poses->info().name;
  report.when_lost = frame_pose_options(session_.scene).when_lost;
  report.latency_s = session_.poses->info().latency_s;
  report.frames = poses_->counts();
  report.faults = session_.poses->faults();
  report.stream = session_.poses->stream();
  report.error = error_;
  report.age_ms = age_ms_;
  report.slip = slip_->report();
  report.lens = lens_->report();
  return report;
}

}  // namespace mixrig::session
