// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/run_compositor.h"

#include <algorithm>
#include <utility>

#include "hal/base/log.h"
#include "host/room/background/frame_lens.h"

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

/// Of depth after the plate; 0 where it is not known.
double depth_delay_s(const capture::Capture& capture) {
  if (capture.depth_mid_exposure == HostTime{}) return 0;
  return std::chrono::duration<double>(capture.depth_mid_exposure - capture.mid_exposure).count();
}

}  // namespace

RunCompositor::RunCompositor(const Session& session, RunOptions& options, RunReport& report)
    : session_(session),
      options_(options),
      report_(report),
      keeper_(session, live()),
      light_keeper_(session, live()),
      look_keeper_(session, live()),
      exchange_(session, live()) {}

Result<void> RunCompositor::open(ObjectMover* mover, WorkGate* gate) {
  mover_ = mover, wanted_focus_ = session_.scene.focus;
  MIXRIG_ASSIGN(compositor_, make_compositor(session_.setup, session_.backend));
  if (options_.save_room) MIXRIG_TRY(check_save(session_, *options_.save_room));
  if (!options_.scene && live()) options_.scene = std::make_shared<SceneFollower>(session_, true);
  if (options_.watch_room.value_or(live())) MIXRIG_TRY(keeper_.open(options_.changes, gate));
  if (session_.scene.light.follow) MIXRIG_TRY(light_keeper_.open(gate));
  look_keeper_.open(gate);
  no_depth_m_.reset(session_.setup.tof.size_px());
  report_.backend = backend_of(*compositor_);
  report_.renderer = compositor_->state().renderer;
  report_.size = session_.setup.view.size_px;
  return {};
}

void RunCompositor::follow_changes() {
  exchange_.use(keeper_.take_learned());
  if (options_.scene) use(options_.scene->take_edited());
  exchange_.exchange(compositor_, last_pose_);
  if (options_.controls != nullptr)
    options_.controls->can_focus = exchange_.scene().focus.has_value();
  light_keeper_.take_factors();
  if (options_.scene) scene_differs_ = options_.scene->fill(exchange_.scene(), frame_scene_);
}

/// What the scene says newly is sharp takes the place of what was clicked.
void RunCompositor::use(EditedScenePtr edited) {
  if (!edited) return;
  const bool refocuses = !same_focus(wanted_focus_, edited->scene.focus);
  if (refocuses && options_.controls != nullptr) options_.controls->focus_at = -1;
  wanted_focus_ = edited->scene.focus;
  exchange_.use(std::move(edited));
}

/// That an operator chose, where the scene in use has a focus and the view that pixel.
std::optional<glm::ivec2> RunCompositor::focus_pixel() const {
  const int at = options_.controls != nullptr ? options_.controls->focus_at.load() : -1;
  const Size view = session_.setup.view.size_px;
  const glm::ivec2 pixel(at & 0xFFFF, at >> 16);
  if (at < 0 || !exchange_.scene().focus || pixel.x >= view.width || pixel.y >= view.height)
    return std::nullopt;
  return pixel;
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

/// Objects with physics go on from where the scene has been changed to put them.
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
       depth_delay_s(*composite.capture), composite.motion, look_keeper_.look_of(composite),
       shared ? &shared : nullptr, composite.objects_shown},
      images);
}

void RunCompositor::count_plate(const capture::Capture& capture) {
  if (!live()) return;
  PlateReport& plates = report_.plates ? *report_.plates : report_.plates.emplace();
  const bool imported = compositor_->state().imported_plate;
  ++(imported ? plates.imported : plates.copied);
  if (imported) plates.layout = capture.picture->raw().layout;
}

/// Has the source give plates as the compositor in use reads them.
void RunCompositor::share_plates() {
  const render::PlateNeed need = compositor_->state().plate_need;
  if (need == std::exchange(asked_, need)) return;
  session_.source->share_plates({.shared = need != render::PlateNeed::kDecoded,
                                 .decoded = need != render::PlateNeed::kShared});
}

/// As the scene has it, times what was seen to change.
std::optional<render::FrameLight> RunCompositor::frame_light() {
  const auto scene = scene_differs_ ? std::optional(frame_scene_.light) : std::nullopt;
  return light_keeper_.is_open() ? light_keeper_.changed(exchange_.scene().light, scene) : scene;
}

Result<void> RunCompositor::see(const output::CompositePtr& composite) {
  MIXRIG_TRY(light_keeper_.push(composite));
  MIXRIG_TRY(look_keeper_.push(composite));
  return composite->capture->depth_m.empty() ? Result<void>() : keeper_.push(composite);
}

/// Versions of the scene that were read, by whether they were composited.
SceneEdits RunCompositor::edits() const {
  SceneEdits edits = options_.scene->edits();
  edits.taken -= exchange_.refused_scenes(), edits.refused += exchange_.refused_scenes();
  return edits;
}

Result<void> RunCompositor::finish() {
  MIXRIG_TRY(keeper_.finish());
  MIXRIG_TRY(light_keeper_.finish());
  if (light_keeper_.is_open()) report_.light = light_keeper_.report();
  MIXRIG_TRY(look_keeper_.finish());
  report_.look = look_keeper_.report();
  exchange_.finish();
  if (report_.plates) report_.plates->why_copied = compositor_->state().why_copied;
  compositor_.reset();  // its buffers are not needed beside the sheet's
  report_.swap_ms = exchange_.swap_ms();
  if (options_.scene) report_.scene_edits = edits();
  if (keeper_.is_open()) {
    report_.room_changes = keeper_.report();
    report_.room_changes->swap_ms = exchange_.swap_ms();
  }
  if (!options_.save_room) return {};
  if (keeper_.kept() != nullptr) return save_kept(session_, *keeper_.kept(), *options_.save_room);
  log_warning("session", "--save-room " + options_.save_room->string() +
                             ": no change was accepted, so that nothing was written");
  return {};
}

}  // namespace mixrig::session
