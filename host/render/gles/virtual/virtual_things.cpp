// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/virtual/virtual_things.h"

#include <algorithm>

#include "host/render/frame/look_filter.h"

namespace mixrig::render::gles {

VirtualThings::VirtualThings(const CompositorSetup& setup, const FrameParams& frame)
    : setup_(&setup), frame_(&frame), used_look_(setup) {
  for (const Draw& draw : frame.draws) meshes_.emplace_back(*draw.mesh);
}

Result<VirtualThings> VirtualThings::create(const CompositorSetup& setup, const Tables& tables,
                                            const FrameParams& frame) {
  VirtualThings things(setup, frame);
  MIXRIG_TRY(things.create_passes(tables));
  return things;
}

/// Makes only the passes that the scene needs.
Result<void> VirtualThings::create_passes(const Tables& tables) {
  GLint most_texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most_texels);
  MIXRIG_TRY(check_samples(tables.view_size, most_texels));
  MIXRIG_ASSIGN(virtual_, VirtualPass::create(frame_->glossy || frame_->emits));
  MIXRIG_ASSIGN(edges_, EdgePass::create(tables));
  MIXRIG_ASSIGN(light_, LightPass::create(tables, *setup_));
  light_.set_contacts(*frame_);
  if (!setup_->light.lamps.empty()) {
    MIXRIG_ASSIGN(shadow_, ShadowPass::create());
  }
  if (!frame_->people_lamps.empty()) {
    MIXRIG_ASSIGN(people_shadow_, PeopleShadowPass::create(tables));
  }
  if (setup_->look.measures()) {
    MIXRIG_ASSIGN(look_, LookPass::create(tables));
  }
  if (setup_->look.motion) {
    MIXRIG_ASSIGN(motion_, MotionPass::create(tables));
  }
  return {};
}

void VirtualThings::set_view(const Tables& tables) {
  light_.set_view(tables);
  if (people_shadow_) people_shadow_->set_view(tables);
}

void VirtualThings::take_look(const FrameInput& input) {
  const PictureLook* const look = used_look_.take(input);
  if (look == nullptr) return;
  look_->set(*look);
  shaded_ = true;
}

Result<void> VirtualThings::draw(StageTimer& timer) {
  ++frames_;
  if (!frame_->pose_changed) return {};
  if (!frame_->virtual_rect.empty()) {
    const StageScope stage(timer, Stage::kVirtual);
    MIXRIG_TRY(virtual_.draw(*frame_, meshes_));
  }
  const bool has_maps = std::any_of(frame_->lamps.begin(), frame_->lamps.end(),
                                    [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
  has_shadows_ = has_maps || !frame_->contacts.empty();
  if (!has_maps || !frame_->maps_changed) return {};
  const StageScope stage(timer, Stage::kShadow);
  return shadow_.draw(*frame_, meshes_);
}

/// Shades the objects and softens their edges. `people_maps`: of PeopleShadowPass, else 0.
void VirtualThings::shade(GLuint people_maps) {
  light_.shade_virtual(*frame_, virtual_, shadow_.maps(), people_maps);
  edges_.draw(frame_->virtual_rect, used_look_.edge_tap(), light_.virtual_color(),
              light_.virtual_w());
}

Result<void> VirtualThings::light(const Room& room, const KeyPass* key, bool people,
                                  StageTimer& timer) {
  const StageScope stage(timer, Stage::kLight);
  people = people && key != nullptr;
  shaded_ |= frame_->pose_changed || (people_shadow_ && people);
  if (frame_->pose_changed) {
    if (frame_->room_changed) MIXRIG_TRY(light_.set_room(*frame_));
    light_.set_lamps(*frame_);
    if (!people_shadow_ || !people) shade(0);
    if (light_map(key) != nullptr && is_lit(room))
      light_.draw_background(*room.light_m(), shadow_.maps(), room.normal());
    else if (light_map(key) != nullptr)
      light_.skip_background();
  }
  if (!people) return {};
  if (people_shadow_) MIXRIG_TRY(people_shadow_->draw(*frame_, key->matte(), key->visible_w()));
  if (light_map(key) != nullptr) {
    LightPass::PastPeople past;
    if (people_shadow_ && is_lit(room))
      past = {people_shadow_->maps(), room.light_m(), room.normal()};
    light_.draw_people({key->blocks(), key->matte(), key->visible_w()}, shadow_.maps(), past);
  }
  if (people_shadow_) shade(people_shadow_->maps());
  return {};
}

void VirtualThings::blur(const std::optional<CameraMotion>& motion) {
  mixed_color_ = &edges_.virtual_color(), mixed_w_ = &edges_.virtual_w();
  mixed_rect_ = frame_->virtual_rect;
  if (look_ && look_->blurs()) {
    if (shaded_) look_->draw(frame_->virtual_rect, *mixed_color_, *mixed_w_);
    mixed_color_ = &look_->virtual_color(), mixed_w_ = &look_->virtual_w();
    shaded_ = false;
  }
  if (!motion_) return;
  const MotionParams params = motion_params(motion, setup_->view, *frame_);
  if (!params.blurs()) return;
  motion_->draw(params, *mixed_color_, *mixed_w_);
  mixed_color_ = &motion_->virtual_color(), mixed_w_ = &motion_->virtual_w();
  const Size view = mixed_color_->size;
  mixed_rect_ = {0, 0, view.width, view.height};  // motion may carry them anywhere
}

void VirtualThings::add_to(MixInput& input) const {
  input.virtual_color = mixed_color_ != nullptr ? mixed_color_ : &edges_.virtual_color();
  input.objects = mixed_rect_;
  input.virtual_w = mixed_w_ != nullptr ? mixed_w_ : &edges_.virtual_w();
  if (!look_ || look_->noise() == nullptr) return;
  input.noise = look_->noise();
  input.grain = look_->grain();
  input.grain_offset = grain_offset(frames_ - 1);
}

}  // namespace mixrig::render::gles
