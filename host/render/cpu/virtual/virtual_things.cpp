// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/virtual_things.h"

#include "host/render/cpu/mix/motion.h"
#include "host/render/cpu/virtual/soften_edges.h"

namespace mixrig::render::cpu {

VirtualThings::VirtualThings(const CompositorSetup& setup, const BackgroundView& background,
                             const Tables& tables, const FrameParams& frame, int threads)
    : setup_(setup),
      background_(background),
      tables_(tables),
      frame_(frame),
      scratch_(frame, tables.view_size, threads),
      shadow_maps_(frame.lamps.size()),
      light_(tables.view_size),
      look_(setup) {
  const Size size = tables.view_size;
  objects_.reset(size, frame.glossy, frame.emits);
  if (setup.look.motion) {
    make_layer_image(size, moved_.coverage);
    make_layer_image(size, moved_.w);
    make_layer_image(size, moved_.color);
  }
  if (!people_cast()) return;
  people_shadow_ = PeopleShadow(size);
  size_for_people(frame, size, objects_);
  size_for_people(frame, size, light_);
}

LightInput VirtualThings::light_input(MovingBackground* moving, const PeopleShadow* people) const {
  return {.frame = frame_,
          .tables = tables_,
          .background = background_,
          .maps = shadow_maps_,
          .moving = moving,
          .people = people};
}

/// The table of noise is not rebuilt, so the noise keeps the correlation of the first look.
void VirtualThings::take_look(const FrameInput& input) {
  const PictureLook* const look = look_.take(input);
  if (look == nullptr) return;
  look_filter_.reset();
  if (look->filters()) look_filter_ = look_filter(*look);
  drawn_ = true;
  grain_.grain = look->grain;
  if (look->grain.any() && grain_.noise.empty()) grain_.noise = make_grain(look->grain);
}

void VirtualThings::draw(Crew& crew, MovingBackground* moving, StopWatch& watch) {
  grain_.offset = grain_offset(frames_++);
  if (!frame_.pose_changed) return;
  draw_virtual(crew, frame_, scratch_, objects_);
  soften_edges(crew, look_.edge_tap(), scratch_, objects_);
  drawn_ = true;
  watch.lap(Stage::kVirtual);
  shadow_maps_.resize(frame_.lamps.size());
  if (frame_.maps_changed) draw_shadow_maps(crew, frame_, shadow_maps_);
  watch.lap(Stage::kShadow);
  const LightInput input = light_input(moving, nullptr);
  shade_virtual(crew, input, objects_);
  if (has_shadows(frame_) && !setup_.backdrop) light_background(crew, input, light_);
  watch.lap(Stage::kLight);
}

void VirtualThings::light_real(Crew& crew, MovingBackground* moving, const Image<float>& view_w,
                               const Image<std::uint8_t>& matte) {
  if (people_cast()) {
    draw_people_maps(crew, frame_, tables_.warp.view, view_w, matte, people_shadow_);
    drawn_ |= shade_behind_people(crew, light_input(nullptr, &people_shadow_), objects_);
  }
  if (!has_shadows(frame_)) return;
  const bool past_people = people_shadow_.reach != 0 && !setup_.backdrop;
  const LightInput input = light_input(moving, past_people ? &people_shadow_ : nullptr);
  light_visible_background(crew, input, light_);
  light_people(crew, input, view_w, matte, light_);
}

void VirtualThings::blur(Crew& crew, const std::optional<CameraMotion>& motion) {
  mixed_ = &objects_;
  if (look_filter_) {
    if (drawn_) blur_layer(crew, *look_filter_, objects_, blurred_);
    mixed_ = &blurred_.layer;
  }
  drawn_ = false;
  if (!setup_.look.motion) return;
  const MotionParams params = motion_params(motion, setup_.view, frame_);
  if (!params.blurs()) return;
  blur_by_motion(crew, params, *mixed_, moved_);
  mixed_ = &moved_;
}

}  // namespace mixrig::render::cpu
