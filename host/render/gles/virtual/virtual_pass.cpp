// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/virtual/virtual_pass.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/render/gles/gl/gl_convention.h"

namespace mixrig::render::gles {
namespace {
constexpr int kGrain = 128;  // samples by which the target grows

int round_up(int value) { return (value + kGrain - 1) / kGrain * kGrain; }

}  // namespace

Result<void> check_samples(Size view, int most_texels) {
  const int side = kVirtualSamples * std::max(view.width, view.height);
  if (side <= most_texels) return {};
  return Error{ErrorCode::kUnsupported,
               fmt::format("the OpenGL ES driver has textures of {} texels, virtual objects in a "
                           "view of {} x {} need {}: use a smaller view or --backend cpu",
                           most_texels, view.width, view.height, side)};
}

Result<VirtualPass> VirtualPass::create(bool glossy) {
  VirtualPass pass;
  pass.glossy_ = glossy;
  MIXRIG_ASSIGN(pass.program_, make_program("virtual.vert", "virtual.frag"));
  pass.at_ = {pass.program_.location("camera_from_object"),
              pass.program_.location("camera_from_object_normal"),
              pass.program_.location("clip_from_camera"),
              pass.program_.location("base_color"),
              pass.program_.location("double_sided"),
              pass.program_.location("gloss_factor"),
              pass.program_.location("emission_factor"),
              pass.program_.location("has_normal_map"),
              pass.program_.location("normal_scale")};
  return pass;
}

Result<void> VirtualPass::grow(Size samples) {
  const Size now = target_.size;
  if (samples.width <= now.width && samples.height <= now.height) return {};
  const Size size{round_up(std::max(samples.width, now.width)),
                  round_up(std::max(samples.height, now.height))};
  albedo_ = make_texture(size, GL_SRGB8_ALPHA8);
  normal_ = make_texture(size, GL_RGB10_A2);
  depth_ = make_texture(size, GL_DEPTH_COMPONENT32F);
  if (!glossy_) {
    MIXRIG_ASSIGN(target_, make_target({&albedo_, &normal_}, &depth_));
    return {};
  }
  gloss_ = make_texture(size, GL_RGBA8), emission_ = make_texture(size, GL_SRGB8_ALPHA8);
  MIXRIG_ASSIGN(target_, make_target({&albedo_, &normal_, &gloss_, &emission_}, &depth_));
  return {};
}

void VirtualPass::draw_sample(const FrameParams& params, const std::vector<GpuMesh>& meshes,
                              glm::ivec2 sample) {
  const Rect& rect = params.virtual_rect;
  const Size size{rect.x1 - rect.x0, rect.y1 - rect.y0};
  glViewport(sample.x * size.width, sample.y * size.height, size.width, size.height);
  const glm::vec2 place_px = glm::vec2(sample) * 0.5F - 0.25F +
                             kSampleTurnPx * glm::vec2(1 - 2 * sample.y, 2 * sample.x - 1);
  for (std::size_t i = 0; i < params.draws.size(); ++i) {
    const Draw& draw = params.draws[i];
    const PinholeParams window =
        window_of(draw.params.view, glm::vec2(rect.x0, rect.y0) + place_px, 1);
    draw.mesh->double_sided ? glDisable(GL_CULL_FACE) : glEnable(GL_CULL_FACE);
    set_uniform(at_.camera_from_object, draw.params.camera_from_object);
    set_uniform(at_.camera_from_object_normal, draw.params.camera_from_object_normal);
    set_uniform(at_.clip_from_camera, clip_from_camera(window, size));
    set_uniform(at_.base_color, draw.params.base_color);
    set_uniform(at_.double_sided, draw.mesh->double_sided);
    const MeshView& mesh = *draw.mesh;
    set_uniform(at_.gloss,
                glm::vec3(mesh.gloss.metallic, mesh.gloss.roughness, mesh.gloss.specular));
    set_uniform(at_.emission, mesh.emission);
    set_uniform(at_.has_normal_map, !mesh.normal_map.empty() && !mesh.uv.empty());
    set_uniform(at_.normal_scale, mesh.normal_scale);
    meshes[i].bind_maps();
    meshes[i].draw();
  }
}

Result<void> VirtualPass::draw(const FrameParams& params, const std::vector<GpuMesh>& meshes) {
  const Rect& rect = params.virtual_rect;
  const Size samples{kVirtualSamples * (rect.x1 - rect.x0), kVirtualSamples * (rect.y1 - rect.y0)};
  MIXRIG_TRY(grow(samples));
  glBindFramebuffer(GL_FRAMEBUFFER, target_.handle.get());
  glClearColor(0, 0, 0, 0);
  glClearDepthf(0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glCullFace(GL_BACK);
  glFrontFace(GL_CW);  // counter-clockwise in the picture, whose y points down
  program_.use();
  for (int y = 0; y < kVirtualSamples; ++y)
    for (int x = 0; x < kVirtualSamples; ++x) draw_sample(params, meshes, {x, y});
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  return {};
}

}  // namespace mixrig::render::gles
