// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/run_compositor.h"

#include <algorithm>
#include <utility>

#include "hal/base/log.h"
#include "host/room/background/frame_lens.h"
#include "host/run/watchers/change_sink.h"

namespace mixrig::session {
namespace {

bool same_focus(const std::optional<scene::FocusSettings>& a,
                const std::optional<scene::FocusSettings>& b) {
  if (!a || !b) return !a && !b;
  return a->distance_m == b->distance_m && a->pixel == b->pixel && a->f_number == b->f_number;
}

/// The picture of a capture in its camera's memory.
class CapturedPlate final : public render::SharedPlate {
 public:
  explicit CapturedPlate(const capture::Capture& capture) : picture_(capture.picture) {}
  const RawPicture& raw() const override { return picture_->raw(); }
  ImageView<const Rgb8> decoded() const override { return picture_->decoded(); }
  std::shared_ptr<const void> hold() const override { return picture_; }
  explicit operator bool() const { return picture_ != nullptr; }

 private:
  const std::shared_ptr<const capture::CameraPicture>& picture_;  // of a capture that outlives it
};

}  // namespace

RunCompositor::RunCompositor(const Session& session, const RunOptions& options,
                             std::shared_ptr<SceneFollower> follower, output::RunOrders* orders)
    : session_(session),
      options_(options),
      follower_(std::move(follower)),
      orders_(orders),
      focus_px_(options.focus_px),
      keeper_(session, live()),
      light_keeper_(session, live()),
      look_keeper_(session, live()),
      exchange_(session, live()) {}

Result<void> RunCompositor::open(ObjectMover* mover, WorkGate* gate) {
  mover_ = mover, wanted_focus_ = session_.scene.focus;
  MIXRIG_ASSIGN(compositor_, make_compositor(session_.setup, session_.backend));
  if (options_.save_room) MIXRIG_TRY(check_save(session_, *options_.save_room));
  if (!follower_ && live()) follower_ = std::make_shared<SceneFollower>(session_, true);
  if (options_.watch_room.value_or(live()))
    MIXRIG_TRY(keeper_.open(options_.changes, orders_, gate));
  if (session_.scene.light.follow) MIXRIG_TRY(light_keeper_.open(gate));
  look_keeper_.open(gate);
  no_depth_m_.reset(session_.setup.tof.size_px());
  renderer_ = compositor_->state().renderer;
  backend_ = backend_of(*compositor_);
  tell_possible();
  return {};
}

void RunCompositor::follow_changes() {
  exchange_.use(keeper_.take_learned());
  while (orders_ != nullptr) {
    const auto order = orders_->take<output::FocusAt>();
    if (!order) break;
    focus_px_ = order->pixel;
  }
  if (follower_) use(follower_->take_edited());
  exchange_.exchange(compositor_, last_pose_);
  tell_possible();
  light_keeper_.take_factors();
  if (follower_) scene_differs_ = follower_->fill(exchange_.scene(), frame_scene_);
}

/// Reports what an operator can ask of the compositor, and where it is sharp.
void RunCompositor::tell_possible() const {
  if (orders_ == nullptr) return;
  const bool watches = keeper_.is_open();
  orders_->tell([&](output::RunState& run) {
    run.can_learn = watches, run.can_scan = watches && ChangeSink::can_scan(session_);
    run.can_focus = exchange_.scene().focus.has_value(), run.focus_px = focus_px_;
  });
}

/// Uses an edited scene; its new focus replaces the clicked one.
void RunCompositor::use(EditedScenePtr edited) {
  if (!edited) return;
  const bool refocuses = !same_focus(wanted_focus_, edited->scene.focus);
  if (refocuses) focus_px_.reset();
  wanted_focus_ = edited->scene.focus;
  exchange_.use(std::move(edited));
}

/// Focus pixel that an operator chose; nullopt unless the scene in use has a focus and the view
/// holds the pixel.
std::optional<glm::ivec2> RunCompositor::focus_pixel() const {
  const Size view = session_.setup.view.size_px;
  if (!focus_px_ || !exchange_.scene().focus || focus_px_->x >= view.width ||
      focus_px_->y >= view.height)
    return std::nullopt;
  return focus_px_;
}

void RunCompositor::move_objects(output::Composite& composite) {
  composite.world_from_object.clear();
  if (mover_ == nullptr) {
    if (scene_differs_ || exchange_.is_edited())
      composite.world_from_object = frame_scene_.world_from_object;
    return;
  }
  place_moved_objects();
  const auto poses =
      mover_->advance(times_.next(composite.capture->time_s), composite.world_from_target);
  composite.world_from_object.assign(poses.begin(), poses.end());
}

/// Moves objects with physics to where a change of the scene puts them.
void RunCompositor::place_moved_objects() {
  const auto& wanted = frame_scene_.world_from_object;
  for (std::size_t i = 0; i < std::min(wanted.size(), wanted_poses_.size()); ++i)
    if (!(wanted[i] == wanted_poses_[i])) mover_->place(i, wanted[i]);
  wanted_poses_ = wanted;
}

Result<void> RunCompositor::compose(const output::Composite& composite, render::OutputMask wanted,
                                    render::FrameOutput& images) {
  images.wanted = wanted;
  last_pose_ = composite.world_from_target;
  share_plates();
  const Image<float>& depth_m = composite.capture->depth_m;
  const CapturedPlate shared(*composite.capture);
  const bool in_place = shared && asked_ == render::PlateNeed::kShared;
  const ImageView<const Rgb8> plate =
      in_place ? composite.capture->plate : plate_of(*composite.capture);
  return compositor_->compose(
      {plate, depth_m.empty() ? no_depth_m_ : depth_m, composite.world_from_target,
       frame_lens(*composite.capture), composite.world_from_object,
       composite.capture->depth2.depth_m, frame_light(), focus_pixel(), composite.capture->time_s,
       composite.motion, look_keeper_.look_of(composite), shared ? &shared : nullptr,
       composite.objects_shown},
      images);
}

void RunCompositor::count_plate(const capture::Capture& capture) {
  if (!live()) return;
  PlateReport& plates = plates_ ? *plates_ : plates_.emplace();
  const bool imported = compositor_->state().imported_plate;
  ++(imported ? plates.imported : plates.copied);
  if (imported) plates.layout = capture.picture->raw().layout;
}

/// Asks the source for plates in the form that the compositor in use reads.
void RunCompositor::share_plates() {
  const render::PlateNeed need = compositor_->state().plate_need;
  if (need == std::exchange(asked_, need)) return;
  session_.source->share_plates({.shared = need != render::PlateNeed::kDecoded,
                                 .decoded = need != render::PlateNeed::kShared});
}

/// Light of the scene, times the changes that were seen.
std::optional<render::FrameLight> RunCompositor::frame_light() {
  const auto scene = scene_differs_ ? std::optional(frame_scene_.light) : std::nullopt;
  return light_keeper_.is_open() ? light_keeper_.changed(exchange_.scene().light, scene) : scene;
}

Result<void> RunCompositor::see(const output::CompositePtr& composite) {
  MIXRIG_TRY(light_keeper_.push(composite));
  MIXRIG_TRY(look_keeper_.push(composite));
  return composite->capture->depth_m.empty() ? Result<void>() : keeper_.push(composite);
}

/// Report of the parts, which must have ended.
CompositorReport RunCompositor::report() const {
  CompositorReport report;
  report.backend = backend_, report.renderer = renderer_;
  report.size = session_.setup.view.size_px;
  report.plates = plates_;
  if (plates_) report.plates->why_copied = compositor_->state().why_copied;
  if (light_keeper_.is_open()) report.light = light_keeper_.report();
  report.look = look_keeper_.report();
  report.swap_ms = exchange_.swap_ms();
  if (follower_) {  // versions that were read, by whether they were composited
    SceneEdits& edits = report.scene_edits.emplace(follower_->edits());
    edits.taken -= exchange_.refused_scenes(), edits.refused += exchange_.refused_scenes();
  }
  if (keeper_.is_open()) {
    report.room_changes = keeper_.report();
    report.room_changes->swap_ms = exchange_.swap_ms();
  }
  return report;
}

Result<CompositorReport> RunCompositor::finish() {
  MIXRIG_TRY(keeper_.finish());
  MIXRIG_TRY(light_keeper_.finish());
  MIXRIG_TRY(look_keeper_.finish());
  exchange_.finish();
  CompositorReport done = report();
  compositor_.reset();  // its buffers are not needed beside the sheet's
  MIXRIG_TRY(save_room());
  return done;
}

Result<void> RunCompositor::save_room() const {
  if (!options_.save_room) return {};
  if (keeper_.kept() != nullptr) return save_kept(session_, *keeper_.kept(), *options_.save_room);
  log_warning("session", "--save-room " + options_.save_room->string() +
                             ": no change was accepted, so that nothing was written");
  return {};
}

}  // namespace mixrig::session
