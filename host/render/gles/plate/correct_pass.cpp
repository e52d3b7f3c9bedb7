// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/correct_pass.h"

namespace mixrig::render::gles {
namespace {

void set_noise(const Program& program, const CorrectParams& params) {
  program.set("noise_floor_m", params.noise.floor_m);
  program.set("noise_linear", params.noise.linear);
  program.set("noise_quadratic_per_m", params.noise.quadratic_per_m);
  program.set("step_sigmas", params.step_sigmas);
  program.set("step_min_m", params.step_min_m);
  program.set("step_bends", params.step_bends);
  program.set("bends_part", params.bends_part);
}

}  // namespace

Result<CorrectPass> CorrectPass::create(const Tables& tables) {
  CorrectPass pass;
  pass.ray_ = make_texture(tables.tof_ray.view(), GL_RG32F);
  for (Texture* grid :
       {&pass.depth_, &pass.raw_z_, &pass.bend_, &pass.clean_z_, &pass.step_, &pass.z_})
    *grid = make_texture(tables.tof_size, GL_R32F);
  pass.vertices_ = make_texture(tables.tof_size, GL_RGBA32F);
  MIXRIG_ASSIGN(pass.to_z_, make_step("correct_z.frag", {&pass.z_}));
  MIXRIG_ASSIGN(pass.drop_stray_, make_step("correct_stray.frag", {&pass.raw_z_}));
  MIXRIG_ASSIGN(pass.find_bend_, make_step("correct_bend.frag", {&pass.bend_}));
  MIXRIG_ASSIGN(pass.clean_, make_step("correct_clean.frag", {&pass.clean_z_, &pass.step_}));
  MIXRIG_ASSIGN(pass.smooth_, make_step("correct_smooth.frag", {&pass.z_}));
  MIXRIG_ASSIGN(pass.link_, make_step("correct_links.frag", {&pass.vertices_}));
  pass.to_z_.program.set("depth_is_distance", tables.correct.depth_is_distance);
  pass.drop_stray_.program.set("stray_px_m2", tables.correct.stray_px_m2);
  set_noise(pass.clean_.program, tables.correct);
  return pass;
}

void CorrectPass::draw() const { draw_into(link_.target); }

void CorrectPass::draw_depth() const {
  run(to_z_, {&depth_, &ray_});
  run(drop_stray_, {&z_});
  run(find_bend_, {&raw_z_});
  run(clean_, {&raw_z_, &bend_});
  run(smooth_, {&clean_z_, &step_});
}

void CorrectPass::draw_into(const Target& vertices) const {
  draw_depth();
  run_into(vertices, link_.program, {&z_, &step_});
}

}  // namespace mixrig::render::gles
