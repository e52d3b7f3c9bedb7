// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/warp/warp_pass.h"

#include <array>

#include "host/render/gles/gl/gl_convention.h"

namespace mixrig::render::gles {
namespace {

BufferHandle make_buffer(GLenum target, std::size_t bytes, GLenum usage) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), nullptr, usage);
  return BufferHandle(name);
}

}  // namespace

Result<WarpPass> WarpPass::create(const Tables& tables) {
  MIXRIG_ASSIGN(WarpPass pass, create_without_view(tables));
  pass.w_ = make_texture(tables.view_size, GL_R32F);
  pass.depth_ = make_texture(tables.view_size, GL_DEPTH_COMPONENT32F);
  MIXRIG_ASSIGN(pass.target_, make_target({&pass.w_}, &pass.depth_));
  return pass;
}

Result<WarpPass> WarpPass::create_without_view(const Tables& tables) {
  WarpPass pass;
  pass.tof_size_ = tables.tof_size;
  MIXRIG_ASSIGN(pass.cells_, make_program("cells.comp"));
  pass.group_cells_ = pass.cells_.work_group_size();
  pass.reaches_ = make_texture(tables.tof_size, GL_RGBA32F);
  MIXRIG_ASSIGN(pass.reach_, make_step("warp_reach.frag", {&pass.reaches_}));
  MIXRIG_ASSIGN(pass.warp_, make_program("warp.vert", "warp.frag"));
  pass.set_view(tables);
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  pass.vertex_array_ = VertexArrayHandle(name);
  glBindVertexArray(name);
  pass.indices_ =
      make_buffer(GL_ELEMENT_ARRAY_BUFFER, kCellIndices * sizeof(GLuint) * tables.tof_size.area(),
                  GL_DYNAMIC_COPY);
  pass.arguments_ = make_buffer(GL_DRAW_INDIRECT_BUFFER, 5 * sizeof(GLuint), GL_DYNAMIC_COPY);
  glBindVertexArray(0);
  return pass;
}

void WarpPass::set_pose(const glm::mat4& camera_from_tof) {
  warp_.set("camera_from_tof", camera_from_tof);
  reach_.program.set("camera_from_tof", camera_from_tof);
}

void WarpPass::set_view(const Tables& tables) {
  set_pose(tables.warp.camera_from_tof);
  const Program& reach = reach_.program;
  reach.set("focal_px", tables.warp.view.focal_px);
  reach.set("center_px", tables.warp.view.center_px);
  reach.set("open_reach_now", tables.warp.open_reach);
  reach.set("shut_reach_now", tables.warp.shut_reach);
  reach.set("mixed_pixels", tables.warp.mixed_pixels);
  warp_.set("clip_from_camera", clip_from_camera(tables.warp.view, tables.view_size));
}

void WarpPass::find_triangles(const Texture& vertices) const {
  constexpr std::array<GLuint, 5> kNone = {0, 1, 0, 0, 0};  // no index yet, one instance
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, arguments_.get());
  glBufferSubData(GL_DRAW_INDIRECT_BUFFER, 0, sizeof kNone, kNone.data());
  cells_.use();
  bind(0, vertices);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, arguments_.get());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, indices_.get());
  const int cells = (tof_size_.width - 1) * (tof_size_.height - 1);
  glDispatchCompute(static_cast<GLuint>((cells + group_cells_ - 1) / group_cells_), 1, 1);
  // The next frame resets the arguments: that write waits as well.
  glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);
}

void WarpPass::clear() const {
  bind(target_);
  glClearColor(0, 0, 0, 0);
  glClearDepthf(0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void WarpPass::finish() const {
  bind(target_);
  drop_depth(target_);
}

void WarpPass::add(const Texture& vertices, const Texture& tof_ray, const Texture& raw_z_m,
                   const Target& target) const {
  find_triangles(vertices);
  run(reach_, {&vertices, &tof_ray, &raw_z_m});
  bind(target);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  warp_.use();
  bind(0, vertices);
  bind(1, tof_ray);
  bind(2, reaches_);
  glBindVertexArray(vertex_array_.get());
  glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
}

}  // namespace mixrig::render::gles
