// SPDX-License-Identifier: Apache-2.0
// Composites one frame, from its input pictures to its images.
#include <utility>

#include "hal/base/log.h"
#include "host/render/contract/frame_io.h"
#include "host/render/frame/focus_discs.h"
#include "host/render/gles/gles_compositor.h"

namespace mixrig::render::gles {

/// Imports the plate from its camera's memory; null if it must be copied. Decodes it on the host if
/// pixels are needed there.
const ImportedPlanes* GlesCompositor::import_plate(FrameInput& input) {
  const ImportedPlanes* planes = nullptr;
  if (input.shared != nullptr && state_.plate_need != PlateNeed::kDecoded) {
    planes = imports_->find(input.shared->raw());
    if (planes == nullptr) {
      state_.plate_need = PlateNeed::kDecoded, state_.why_copied = imports_->why();
      log_warning("render", "camera pictures are copied from now on: " + state_.why_copied);
    }
  }
  state_.imported_plate = planes != nullptr;
  const bool measures = !setup_.objects.empty() && !std::exchange(has_look_, true);
  const bool on_host = planes == nullptr || measures;
  if (input.plate.empty() && input.shared != nullptr && on_host)
    input.plate = input.shared->decoded();
  return planes;
}

Result<void> GlesCompositor::submit(const FrameInput& given, OutputMask wanted) {
  MIXRIG_TRY(check_frame(given, tables_, true));
  MIXRIG_TRY(context_.make_current());
  FrameInput input = given;
  const bool alone = flight_.count() == 0;
  MIXRIG_ASSIGN(Frame* const frame, flight_.push());
  frame->wanted = with_needed(wanted, gpu_colors_.has_value());
  frame->timer->begin_frame(alone);
  const ImportedPlanes* const planes = import_plate(input);
  if (planes != nullptr) frame->plate_memory = input.shared->hold();
  auto drawn = draw(input, planes, *frame);
  if (!drawn) {
    if (frame->plate_memory) glFinish();
    frame->plate_memory.reset();
    flight_.drop_last();
    return drawn;
  }
  if (frame->wanted & kGpuColor)
    frame->gpu_color =
        gpu_colors_->copy(passes_.focus ? passes_.focus->color() : passes_.mix.color());
  {
    const StageScope stage(*frame->timer, Stage::kReadback);
    frame->images.start(frame->wanted, passes_, light_map());
  }
  frame->done.set();
  return {};
}

/// Runs the passes, in the order of docs/method/compositor.md.
Result<void> GlesCompositor::draw(const FrameInput& input, const ImportedPlanes* planes,
                                  Frame& frame) {
  StageTimer& timer = *frame.timer;
  {
    const StageScope stage(timer, Stage::kUpload, true);
    MIXRIG_TRY(upload(input, planes == nullptr));
  }
  const NeededPasses needed = needed_passes(frame.wanted, things_ != nullptr, setup_);
  if (passes_.plate.draws() || planes != nullptr) {
    const StageScope stage(timer, Stage::kPlate);
    if (planes != nullptr) passes_.plate.decode(input.shared->raw(), *planes);
    if (passes_.plate.draws()) passes_.plate.draw();
  }
  if (passes_.room.is_drawn()) {
    const bool other = std::exchange(room_by_, frame_) != frame_;
    if (other || frame_->params().pose_changed)
      passes_.room.draw(frame_->world_from_camera(), things_ != nullptr, meter_, timer);
    tone_ = tone_of(input);
  }
  draw_depth(passes_.second_depth && !input.tof2_depth_m.empty(), timer);
  if (things_) MIXRIG_TRY(things_->draw(timer));
  if (passes_.key && needed.key) {
    const StageScope stage(timer, Stage::kKey);
    key_people();
  }
  if (things_) MIXRIG_TRY(things_->light(passes_.room, key(), needed.light, timer));
  if (things_ && needed.mix) things_->blur(input.motion);
  if (!needed.mix && !(frame.wanted & kMatte)) return {};
  const bool colors = frame.wanted & (kColor | kGpuColor), focuses = passes_.focus && colors;
  {
    const StageScope stage(timer, Stage::kMix);
    MIXRIG_TRY(draw_mix(frame.wanted | (colors ? kColor : 0) | (focuses ? kMixedDepth : 0)));
  }
  if (!focuses) return {};
  const StageScope stage(timer, Stage::kFocus);
  passes_.focus->draw(focus_of(setup_, input), passes_.mix.color(), passes_.mix.mixed_m());
  return {};
}

/// Runs passes correct, agree and warp; `two`: for both depth cameras.
void GlesCompositor::draw_depth(bool two, StageTimer& timer) {
  const CorrectPass& correct = passes_.correct;
  {
    const StageScope stage(timer, Stage::kCorrect);
    if (two)
      passes_.second_depth->correct_both(correct);
    else
      correct.draw();
  }
  const StageScope stage(timer, Stage::kWarp);
  passes_.warp.draw(correct.vertices(), correct.tof_ray(), correct.raw_z_m());
  if (two) passes_.second_depth->add_to(passes_.warp);
  passes_.warp.finish();
}

ToneCurve GlesCompositor::tone_of(const FrameInput& input) {
  return input.plate.empty() ? meter_.curve(input.shared->raw()) : meter_.curve(input.plate);
}

/// Uploads the frame's pictures, and computes on the host what depends on them.
Result<void> GlesCompositor::upload(const FrameInput& input, bool with_plate) {
  follow(input);
  passes_.take_look(input);
  if (!passes_.room.is_drawn()) tone_ = tone_of(input);
  if (passes_.key) passes_.key->follow(input, passes_.plate);
  if (with_plate) MIXRIG_TRY(passes_.plate.upload_plate(input.plate));
  passes_.correct.upload_depth(input.tof_depth_m);
  if (passes_.second_depth && !input.tof2_depth_m.empty())
    passes_.second_depth->upload_depth(input.tof2_depth_m);
  return {};
}

/// Draws the matte and people's depth.
void GlesCompositor::key_people() {
  const Room& room = passes_.room;
  passes_.key->draw(frame_->params().key, passes_.plate,
                    {passes_.warp.w(), passes_.plate.in_view(), room.color(), room.color_sigma(),
                     tone_, room.limit_w()});
}

/// Takes the frame's lens, light, poses and look.
void GlesCompositor::follow(const FrameInput& input) {
  const bool moved = lens_.follow(input.lens, setup_, tables_);
  if (moved) see_through_lens();
  const SetupChanges changes{moved, place_objects(input.world_from_object, setup_),
                             set_light(input.light, setup_)};
  frame_ = &frames_.update(lens_.world_from_pupil(input.world_from_target), changes,
                           !input.objects_shown);
  std::optional<VirtualThings>& things = frames_.hides() ? passes_.set_things : passes_.all_things;
  things_ = things ? &*things : nullptr;
}

/// Rebuilds what depends on the lens.
void GlesCompositor::see_through_lens() {
  passes_.plate.set_lens(setup_.target, setup_.view);
  meter_.see_through(setup_);
  passes_.set_view(setup_, tables_);
}

Result<void> GlesCompositor::draw_mix(OutputMask wanted) {
  MixInput input;
  const KeyPass* const people = key();
  const Room& room = passes_.room;
  input.plate = &passes_.plate.in_view();
  input.visible_w = people ? &people->visible_w() : &passes_.warp.w();
  input.matte = people ? &people->matte() : nullptr;
  input.background_m = tables_.has_background ? &room.depth_m(things_ != nullptr) : nullptr;
  input.people = people ? &people->blocks() : nullptr;
  input.room = people ? &people->room() : nullptr;
  input.learned = &room.color();
  input.light = light_map() != nullptr ? &light_map()->light() : nullptr;
  if (things_) things_->add_to(input);
  input.tone = tone_;
  return passes_.mix.draw(input, wanted);
}

Result<void> GlesCompositor::collect(FrameOutput& output) {
  MIXRIG_TRY(context_.make_current());
  MIXRIG_ASSIGN(Frame* const frame, flight_.pop());
  MIXRIG_TRY(frame->done.wait());
  frame->plate_memory.reset();
  {
    const StageScope stage(*frame->timer, Stage::kReadback, true);
    output.wanted = frame->wanted;
    size_outputs(tables_.view_size, frame->wanted, output);
    MIXRIG_TRY(frame->images.fetch(output));
    output.gpu_color = std::move(frame->gpu_color);
  }
  state_.stage_times = frame->timer->finish_frame();
  return {};
}

}  // namespace mixrig::render::gles
