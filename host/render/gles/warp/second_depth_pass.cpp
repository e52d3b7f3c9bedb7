// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/warp/second_depth_pass.h"

namespace mixrig::render::gles {
namespace {

void set_agreement(const Program& program, const AgreeParams& params) {
  program.set("other_from_tof", params.other_from_tof);
  program.set("focal_px", params.other.focal_px);
  program.set("center_px", params.other.center_px);
  program.set("px_per_px", params.px_per_px);
  const auto noise = [](const NoiseParams& n) {
    return glm::vec3(n.floor_m, n.linear, n.quadratic_per_m);
  };
  program.set("noise", noise(params.noise));
  program.set("other_noise", noise(params.other_noise));
}

}  // namespace

Result<SecondDepthPass> SecondDepthPass::create(const CompositorSetup& setup,
                                                const Tables& tables) {
  SecondDepthPass pass;
  pass.tables_ = make_second_tables(setup);
  SecondTables& t = pass.tables_;
  MIXRIG_ASSIGN(pass.correct_, CorrectPass::create(t.tof));
  MIXRIG_ASSIGN(pass.warp_, WarpPass::create_without_view(t.tof));
  pass.first_px_ = make_texture(t.second.other_px.view(), GL_RG32F);
  pass.other_px_ = make_texture(t.first.other_px.view(), GL_RG32F);
  pass.agreed_ = make_texture(t.tof.tof_size, GL_R32F);
  pass.first_agreed_ = make_texture(tables.tof_size, GL_R32F);
  MIXRIG_ASSIGN(pass.agree_, make_step("agree.frag", {&pass.agreed_}));
  MIXRIG_ASSIGN(pass.first_agree_, make_step("agree.frag", {&pass.first_agreed_}));
  set_agreement(pass.agree_.program, t.second.params);
  set_agreement(pass.first_agree_.program, t.first.params);
  t.tof.tof_ray = t.first.other_px = t.second.other_px = {};
  return pass;
}

void SecondDepthPass::set_view(const CompositorSetup& setup) {
  render::set_view(setup, tables_);
  warp_.set_view(tables_.tof);
}

void SecondDepthPass::correct_both(const CorrectPass& first) const {
  first.draw_depth();
  correct_.draw_depth();
  run(first_agree_, {&first.z_m(), &first.step_m(), &first.tof_ray(), &correct_.z_m(),
                     &correct_.step_m(), &other_px_});
  run(agree_, {&correct_.z_m(), &correct_.step_m(), &correct_.tof_ray(), &first.z_m(),
               &first.step_m(), &first_px_});
  first.link(first_agreed_);
  correct_.link(agreed_);
}

void SecondDepthPass::add_to(const WarpPass& first) const {
  warp_.add(correct_.vertices(), correct_.tof_ray(), correct_.raw_z_m(), first.target());
}

}  // namespace mixrig::render::gles
