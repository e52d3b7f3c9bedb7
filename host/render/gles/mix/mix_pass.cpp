// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/mix/mix_pass.h"

#include <array>
#include <utility>

#include "host/render/gles/key/key_pass.h"
#include "host/render/tables/background_model.h"

namespace mixrig::render::gles {
namespace {

/// Enables only the attachments of the target that hold wanted images.
void choose_attachments(const Target& target, OutputMask wanted) {
  constexpr std::array<OutputMask, 4> kHeld = {kColor | kMatte, kMixedDepth, kSegmentedDepth,
                                               kLayer};  // in the order of MixOutput
  std::array<GLenum, 4> buffers{};
  for (std::size_t i = 0; i < buffers.size(); ++i)
    buffers[i] =
        wanted & kHeld[i] ? GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i) : GLenum{GL_NONE};
  bind(target);
  glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
}

}  // namespace

Result<MixPass> MixPass::create(const Tables& tables, const CompositorSetup& setup) {
  MixPass pass;
  pass.color_ = make_texture(tables.view_size, GL_SRGB8_ALPHA8);
  pass.mixed_ = make_texture(tables.view_size, GL_R32F);
  pass.segmented_ = make_texture(tables.view_size, GL_R32F);
  MIXRIG_ASSIGN(pass.target_, make_target({&pass.color_, &pass.mixed_, &pass.segmented_}));
  if (setup.backdrop && !setup.backdrop->picture.empty())
    pass.backdrop_ = make_texture(setup.backdrop->picture, GL_SRGB8);
  else if (setup.backdrop) {
    pass.alpha_ = make_texture(tables.view_size, GL_R8);
    MIXRIG_ASSIGN(pass.make_alpha_, make_step("alpha.frag", {&pass.alpha_}));
    pass.alpha_has_objects_ = pass.make_alpha_.program.location("has_objects");
  }
  MIXRIG_TRY(pass.make_programs(tables, setup));
  return pass;
}

Result<void> MixPass::make_programs(const Tables& tables, const CompositorSetup& setup) {
  MIXRIG_ASSIGN(program_, make_block_program("mix.frag", target_.size, kMayShowPeople, kBlockPx));
  MIXRIG_ASSIGN(room_, make_block_program("mix_room.frag", target_.size, kMayShowPeople, kBlockPx));
  shows_room_ = !setup.backdrop;
  const Image<float> nobody(blocks_of(target_.size));
  const bool keyed = tables.has_background || key_by(setup) != KeyBy::kNothing;
  nobody_ = make_texture(std::as_const(nobody).view(), GL_R32F);
  program_.set("keyed", keyed);
  program_.set("shows_room", shows_room_);
  program_.set("open_walls", setup.open_walls);
  program_.set("has_backdrop", backdrop_.size.area() > 0);
  program_.set("has_color", !setup.background.color.empty() || has_model_color(setup));
  for (const Program* program : {&program_, &room_})
    program->set("has_background", tables.has_background);
  room_.set("others", true);
  tone_ = ToneUniforms(program_);
  has_objects_ = program_.location("has_objects");
  has_light_ = program_.location("has_light");
  room_has_light_ = room_.location("has_light");
  wanted_px_ = program_.location("wanted_px"), other_px_ = room_.location("wanted_px");
  has_grain_ = program_.location("has_grain");
  grain_offset_ = program_.location("grain_offset");
  grain_floor_ = program_.location("grain_floor");
  grain_slope_ = program_.location("grain_slope");
  return {};
}

Result<void> MixPass::draw(const MixInput& input, OutputMask wanted) {
  has_layer_ = wanted & kLayer;
  if (has_layer_ && !layer_target_.handle) {
    layer_ = make_texture(color_.size, GL_R8);
    MIXRIG_ASSIGN(layer_target_, make_target({&color_, &mixed_, &segmented_, &layer_}));
  }
  choose_attachments(target(), wanted);
  drop_content(target());
  draw_blocks(input);
  if (!has_alpha() || !(wanted & kAlpha)) return {};
  make_alpha_.program.use();
  set_uniform(alpha_has_objects_, input.virtual_color != nullptr);
  run(make_alpha_, {input.matte, input.virtual_color});
  return {};
}

/// Draws blocks with people or objects, and the others, which show the room alone.
void MixPass::draw_blocks(const MixInput& input) {
  const Texture& people = input.people != nullptr ? *input.people : nobody_;
  const glm::ivec4 objects(input.objects.x0, input.objects.y0, input.objects.x1, input.objects.y1);
  const glm::ivec4 mixed =
      shows_room_ ? objects : glm::ivec4(0, 0, color_.size.width, color_.size.height);
  if (shows_room_) {
    room_.use();
    set_uniform(other_px_, mixed);
    set_uniform(room_has_light_, input.light != nullptr);
    run_blocks_into(
        target(), room_, people,
        {input.plate, nullptr, input.visible_w, input.background_m, nullptr, input.light});
  }
  program_.use();
  set_uniform(wanted_px_, mixed);
  set_uniform(has_objects_, input.virtual_color != nullptr);
  set_uniform(has_light_, input.light != nullptr);
  tone_.set(input.tone);
  set_uniform(has_grain_, input.noise != nullptr);
  set_uniform(grain_offset_, input.grain_offset);
  set_uniform(grain_floor_, input.grain.floor);
  set_uniform(grain_slope_, input.grain.slope);
  run_blocks_into(target(), program_, people,
                  {input.plate, input.matte, input.visible_w, input.background_m, input.learned,
                   input.light, input.virtual_color, input.virtual_w, input.room,
                   backdrop_.size.empty() ? nullptr : &backdrop_, input.noise});
}

}  // namespace mixrig::render::gles
