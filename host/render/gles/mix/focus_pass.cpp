// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/mix/focus_pass.h"

#include <cmath>
#include <vector>

#include "host/render/frame/focus_discs.h"

namespace mixrig::render::gles {
namespace {

Texture table_of(const std::vector<float>& values) {
  return make_texture(ImageView<const float>{values.data(),
                                             {static_cast<int>(values.size()), 1},
                                             static_cast<std::ptrdiff_t>(values.size())},
                      GL_R32F);
}

}  // namespace

Result<FocusPass> FocusPass::create(const Tables& tables, const CompositorSetup& setup) {
  const Focus& focus = *setup.focus;
  const Size view = tables.view_size;
  const Size tiles{(view.width + kFocusTileWide - 1) / kFocusTileWide,
                   (view.height + kFocusTileHigh - 1) / kFocusTileHigh};
  const int reach = focus_margin(focus);
  const auto blur_px_m = static_cast<float>(0.5 * setup.view.fx_px) * focus.aperture_m;
  FocusPass pass;
  pass.plane_w_ = table_of({focus.distance_m > 0 ? 1 / focus.distance_m : 0});
  pass.area_ = table_of(focus_disc_areas(reach));
  pass.disc_ = make_texture(view, GL_RGBA32F);
  pass.tiles_ = make_texture(tiles, GL_R32F), pass.near_ = make_texture(tiles, GL_R32F);
  pass.color_ = make_texture(view, GL_SRGB8_ALPHA8);
  MIXRIG_ASSIGN(pass.plane_, make_step("focus_plane.frag", {&pass.plane_w_}));
  MIXRIG_ASSIGN(pass.discs_, make_step("focus_disc.frag", {&pass.disc_}));
  MIXRIG_ASSIGN(pass.greatest_, make_step("focus_tiles.frag", {&pass.tiles_}));
  MIXRIG_ASSIGN(pass.around_, make_step("focus_near.frag", {&pass.near_}));
  MIXRIG_ASSIGN(pass.gather_, make_step("focus.frag", {&pass.color_}));
  pass.discs_.program.set("blur_px_m", blur_px_m);
  pass.discs_.program.set("most_radius_px", 0.5F * focus.most_blur_px);
  pass.around_.program.set("reach", glm::ivec2((reach + kFocusTileWide - 1) / kFocusTileWide,
                                               (reach + kFocusTileHigh - 1) / kFocusTileHigh));
  pass.gather_.program.set("blur_px_m", blur_px_m);
  pass.gather_.program.set("stride_from_px", focus.fast ? kFocusFastFromPx : 1 << 20);
  pass.pixel_ = pass.plane_.program.location("pixel");
  return pass;
}

void FocusPass::find_plane(const Focus& focus, const Texture& mixed_m) const {
  if (focus.distance_m > 0) return;  // a fixed focus does not change
  plane_.program.use();
  set_uniform(pixel_, *focus.pixel);
  run_over(plane_, {&mixed_m});
}

void FocusPass::draw(const Focus& focus, const Texture& color, const Texture& mixed_m) const {
  find_plane(focus, mixed_m);
  run(discs_, {&mixed_m, &plane_w_, &area_});
  run(greatest_, {&disc_});
  run(around_, {&tiles_});
  run(gather_, {&color, &disc_, &near_});
}

}  // namespace mixrig::render::gles
