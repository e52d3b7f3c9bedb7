// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/mix/look_pass.h"

#include <algorithm>

#include "host/render/frame/look_filter.h"

namespace mixrig::render::gles {
namespace {

void clear(const Target& target) {
  bind(target);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
}

}  // namespace

Result<LookPass> LookPass::create(const Tables& tables) {
  LookPass pass;
  pass.across_ = make_texture(tables.view_size, GL_RGBA16F);
  pass.color_ = make_texture(tables.view_size, GL_RGBA16F);
  pass.w_ = make_texture(tables.view_size, GL_R32F);
  MIXRIG_ASSIGN(pass.along_, make_step("look_along.frag", {&pass.across_}));
  MIXRIG_ASSIGN(pass.down_, make_step("look_down.frag", {&pass.color_, &pass.w_}));
  return pass;
}

void LookPass::set(const PictureLook& look) {
  grain_ = look.grain;
  if (grain_.any() && noise_.size.empty())
    noise_ = make_texture(ImageView<const PackedNormal>(make_grain(grain_).view()), GL_RGBA8_SNORM);
  blurs_ = look.filters();
  const LookFilter filter = look_filter(look);
  const auto set = [](const Step& step, const char* name, const LookTaps& taps) {
    step.program.set(name, glm::vec3(taps[0], taps[1], taps[2]));
  };
  for (const Step* step : {&along_, &down_}) set(*step, "light_taps", filter.light);
  set(along_, "chroma_taps", filter.chroma_x);
  set(down_, "chroma_taps", filter.chroma_y);
}

void LookPass::draw(const Rect& rect, const Texture& virtual_color,
                    const Texture& virtual_w) const {
  clear(along_.target);
  clear(down_.target);
  if (rect.empty()) return;
  const int x0 = std::max(rect.x0 - kBlurReach, 0), y0 = std::max(rect.y0 - kBlurReach, 0);
  glEnable(GL_SCISSOR_TEST);
  glScissor(x0, y0, rect.x1 + kBlurReach - x0, rect.y1 + kBlurReach - y0);
  run_over(along_, {&virtual_color});
  run_over(down_, {&across_, &virtual_w});
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace mixrig::render::gles
