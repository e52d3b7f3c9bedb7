// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/mix/mix_pass.h"

#include <array>

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
  MIXRIG_ASSIGN(pass.step_, make_step("mix.frag", {&pass.color_, &pass.mixed_, &pass.segmented_}));
  pass.step_.program.set("has_background", tables.has_background);
  pass.step_.program.set("keyed", tables.has_background || key_by(setup) != KeyBy::kNothing);
  pass.step_.program.set("shows_room", !setup.backdrop);
  pass.step_.program.set("open_walls", setup.open_walls);
  if (setup.backdrop && !setup.backdrop->picture.empty())
    pass.backdrop_ = make_texture(setup.backdrop->picture, GL_SRGB8);
  else if (setup.backdrop) {
    pass.alpha_ = make_texture(tables.view_size, GL_R8);
    MIXRIG_ASSIGN(pass.make_alpha_, make_step("alpha.frag", {&pass.alpha_}));
    pass.alpha_has_objects_ = pass.make_alpha_.program.location("has_objects");
  }
  pass.step_.program.set("has_backdrop", pass.backdrop_.size.area() > 0);
  pass.step_.program.set("has_color", !setup.background.color.empty() || has_model_color(setup));
  pass.tone_ = ToneUniforms(pass.step_.program);
  pass.has_objects_ = pass.step_.program.location("has_objects");
  pass.has_light_ = pass.step_.program.location("has_light");
  pass.has_grain_ = pass.step_.program.location("has_grain");
  pass.grain_offset_ = pass.step_.program.location("grain_offset");
  pass.grain_floor_ = pass.step_.program.location("grain_floor");
  pass.grain_slope_ = pass.step_.program.location("grain_slope");
  return pass;
}

Result<void> MixPass::draw(const MixInput& input, OutputMask wanted) {
  has_layer_ = wanted & kLayer;
  if (has_layer_ && !layer_target_.handle) {
    layer_ = make_texture(color_.size, GL_R8);
    MIXRIG_ASSIGN(layer_target_, make_target({&color_, &mixed_, &segmented_, &layer_}));
  }
  choose_attachments(target(), wanted);
  step_.program.use();
  const bool has_objects = input.virtual_color != nullptr;
  set_uniform(has_objects_, has_objects);
  set_uniform(has_light_, input.light != nullptr);
  tone_.set(input.tone);
  set_uniform(has_grain_, input.noise != nullptr);
  set_uniform(grain_offset_, input.grain_offset);
  set_uniform(grain_floor_, input.grain.floor);
  set_uniform(grain_slope_, input.grain.slope);
  run_into(target(), step_.program,
           {input.plate, input.matte, input.visible_w, input.background_m, input.learned,
            input.light, input.virtual_color, input.virtual_w, input.room,
            backdrop_.size.empty() ? nullptr : &backdrop_, input.noise});
  if (!has_alpha() || !(wanted & kAlpha)) return {};
  make_alpha_.program.use();
  set_uniform(alpha_has_objects_, has_objects);
  run(make_alpha_, {input.matte, input.virtual_color});
  return {};
}

}  // namespace mixrig::render::gles
