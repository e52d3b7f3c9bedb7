// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/background/background_pass.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace mixrig::render::gles {
namespace {

Result<void> check_sizes(const BackgroundModel& from) {
  GLint most_px = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most_px);
  const Size largest = from.color.empty() ? from.depth_m.size : from.color.size;
  if (std::max(largest.width, largest.height) <= most_px) return {};
  return Error{ErrorCode::kUnsupported,
               fmt::format("the background's pictures are {}x{}, this GPU takes up to {} pixels a "
                           "side: use the cpu back end or a smaller background",
                           largest.width, largest.height, most_px)};
}

/// Sets the uniforms of common/view.glsl.
void set_rays(const Step& step, const Tables& tables) {
  step.program.set("focal_px", tables.warp.view.focal_px);
  step.program.set("center_px", tables.warp.view.center_px);
}

/// Sets the uniforms of common/view.glsl, and those of common/model.glsl that hold for a take.
void set_model(const Step& step, const Tables& tables, const ModelTables& model, std::size_t faces,
               bool several) {
  set_rays(step, tables);
  step.program.set("model_focal_px", model.camera.focal_px);
  step.program.set("model_center_px", model.camera.center_px);
  step.program.set("faces", static_cast<int>(faces));
  step.program.set("face_rows", model.face_rows);
  step.program.set("several", several);
}

}  // namespace

Result<BackgroundPass> BackgroundPass::create(const Tables& tables, const CompositorSetup& setup,
                                              std::span<const ExposureMeter::Place> places) {
  BackgroundPass pass;
  const Size view = tables.view_size;
  pass.several_ = setup.background_models.size() > 1;
  pass.has_color_ = has_model_color(setup);
  pass.depth_m_ = make_texture(view, GL_R32F);
  pass.spread_m_ = make_texture(view, GL_R32F);
  pass.normal_ = make_texture(view, GL_RGBA16F);
  pass.light_m_ = make_texture(view, GL_R32F);
  pass.row_w_ = make_texture(view, GL_R32F);
  pass.limit_w_ = make_texture(view, GL_R32F);
  if (pass.several_) pass.choice_ = make_texture(view, GL_DEPTH_COMPONENT32F);
  if (pass.has_color_) {
    pass.learned_ = make_texture(view, GL_RGBA16F);
    pass.learned_sigma_ = make_texture(view, GL_R16F);
  }
  int radius_px = 1;
  for (const BackgroundModel& from : setup.background_models) {
    const ModelTables model = make_model_tables(setup, from, !setup.objects.empty());
    MIXRIG_TRY(pass.add_part(tables, from, model));
    radius_px = std::max(radius_px, model.limit_radius_px);
  }
  MIXRIG_TRY(pass.create_limit(setup, radius_px));
  if (pass.has_color_) MIXRIG_TRY(pass.create_places(places));
  return pass;
}

Result<void> BackgroundPass::add_part(const Tables& tables, const BackgroundModel& from,
                                      const ModelTables& model) {
  MIXRIG_TRY(check_sizes(from));
  const bool first = parts_.empty();
  Part part;
  MIXRIG_ASSIGN(part.warp,
                first ? WarpPass::create(model.grid) : WarpPass::create_without_view(model.grid));
  MIXRIG_TRY(create_faces(from, model, part));
  const Size size = from.depth_m.size;
  const Image<float> zeros(size, 0.0F);
  part.w = make_texture(model.w.view(), GL_R32F);
  part.sigma_m =
      make_texture(from.depth_sigma_m.empty() ? zeros.view() : from.depth_sigma_m, GL_R32F);
  const Image<PackedNormal> unknown(size, PackedNormal{});
  part.normal =
      make_texture(model.normal.empty() ? unknown.view() : model.normal.view(), GL_RGBA8_SNORM);
  part.has_color = !from.color.empty();
  MIXRIG_TRY(create_look_ups(tables, from, model, part));
  part.tables = model;
  part.tables.depth_m.clear();
  part.tables.w = {}, part.tables.normal = {};
  parts_.push_back(std::move(part));
  return {};
}

Result<void> BackgroundPass::create_faces(const BackgroundModel& from, const ModelTables& model,
                                          Part& part) {
  MIXRIG_ASSIGN(part.correct, CorrectPass::create(model.grid));
  for (std::size_t i = 0; i < from.world_from_face.size(); ++i) {
    Face& face = part.faces.emplace_back();
    face.world_from_face = from.world_from_face[i];
    face.vertices = make_texture(model.grid.tof_size, part.correct.vertices().internal_format);
    MIXRIG_ASSIGN(face.target, make_target({&face.vertices}));
    part.correct.upload_depth(model.depth_m[i]);
    part.correct.draw_into(face.target);
  }
  return {};
}

Result<void> BackgroundPass::create_look_ups(const Tables& tables, const BackgroundModel& from,
                                             const ModelTables& model, Part& part) {
  const std::size_t faces = part.faces.size();
  MIXRIG_ASSIGN(part.look_up, make_step("background.frag",
                                        {&depth_m_, &spread_m_, &normal_, &light_m_}, choice()));
  set_model(part.look_up, tables, model, faces, several_);
  part.look_up_at = part.look_up.program.location("face_from_camera");
  part.planes_at = part.look_up.program.location("planes");
  if (!part.has_color) return {};
  part.color = make_texture(from.color, GL_SRGB8_ALPHA8, Sampling::kLinear);
  MIXRIG_ASSIGN(part.find_color,
                make_step("background_color.frag", {&learned_, &learned_sigma_}, choice()));
  set_model(part.find_color, tables, model, faces, several_);
  part.find_color.program.set("color_factor", from.color_factor);
  part.find_color.program.set("most_spread", kMostColorSpread);
  part.find_color_at = part.find_color.program.location("face_from_camera");
  return {};
}

Result<void> BackgroundPass::create_places(std::span<const ExposureMeter::Place> places) {
  Image<glm::vec2> at({static_cast<int>(places.size()), 1});
  for (std::size_t i = 0; i < places.size(); ++i)
    at.row(0)[i] = glm::vec2(places[i].view_x, places[i].view_y);
  places_ = make_texture(at.view(), GL_RG32F);
  place_color_ = make_texture(at.size(), GL_RGBA32F);
  place_colors_.resize(places.size());
  MIXRIG_ASSIGN(at_places_, make_step("background_places.frag", {&place_color_}));
  return {};
}

Result<void> BackgroundPass::create_limit(const CompositorSetup& setup, int radius_px) {
  MIXRIG_ASSIGN(rows_, make_step("background_rows.frag", {&row_w_}));
  MIXRIG_ASSIGN(limit_, make_step("background_limit.frag", {&limit_w_}));
  rows_.program.set("radius", radius_px);
  limit_.program.set("radius", radius_px);
  limit_.program.set("threshold_m", setup.key.threshold_m);
  limit_.program.set("noise_factor", setup.key.noise_factor);
  const NoiseParams noise = noise_params(setup.noise);
  limit_.program.set("noise_floor_m", noise.floor_m);
  limit_.program.set("noise_linear", noise.linear);
  limit_.program.set("noise_quadratic_per_m", noise.quadratic_per_m);
  return {};
}

void BackgroundPass::set_view(const Tables& tables, const CompositorSetup& setup) {
  int radius_px = 1;
  for (Part& part : parts_) {
    render::set_view(setup, part.tables);
    part.warp.set_view(part.tables.grid);
    set_rays(part.look_up, tables);
    if (part.has_color) set_rays(part.find_color, tables);
    radius_px = std::max(radius_px, part.tables.limit_radius_px);
  }
  rows_.program.set("radius", radius_px);
  limit_.program.set("radius", radius_px);
}

void BackgroundPass::draw(const geometry::Pose& world_from_camera, bool with_light) {
  draw_surfaces(world_from_camera);
  look_up(with_light);
  run(rows_, {&w()});
  run(limit_, {&row_w_, &depth_m_, &spread_m_});
  if (!has_color_) return;
  find_color();
  run(at_places_, {&places_, &learned_});
}

void BackgroundPass::draw_surfaces(const geometry::Pose& world_from_camera) {
  const WarpPass& view = parts_.front().warp;
  view.clear();
  for (Part& part : parts_)
    for (std::size_t i = 0; i < part.faces.size(); ++i) {
      const FacePose pose = face_pose(part.faces[i].world_from_face, world_from_camera);
      part.pose[i] = pose, part.face_from_camera[i] = pose.face_from_camera;
      if (!may_show(part.tables, i, pose)) continue;
      part.warp.set_pose(pose.camera_from_face);
      part.warp.add(part.faces[i].vertices, part.correct.tof_ray(), part.correct.raw_z_m(),
                    view.target());
    }
  view.finish();
}

namespace {

/// Depth test for several models: a pixel keeps what the model with the largest depth value wrote.
void keep_best(bool first) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(first ? GL_ALWAYS : GL_GREATER);
}

/// Draws one of several models: the first one writes every pixel.
void draw_best(bool first, const Step& step, std::initializer_list<const Texture*> inputs) {
  first ? run(step, inputs) : run_over(step, inputs);
}

}  // namespace

void BackgroundPass::look_up(bool with_light) {
  for (const Part& part : parts_) {
    const bool first = &part == &parts_.front();
    if (several_) keep_best(first);
    part.look_up.program.use();
    set_uniform(part.look_up_at, std::span(part.face_from_camera).first(part.faces.size()));
    std::array<glm::vec3, kMostLightPlanes + 1> planes{};  // zero: there is none
    if (with_light)
      planes_in_camera(part.tables, std::span(part.pose).first(part.faces.size()), planes);
    set_uniform(part.planes_at,
                std::span<const glm::vec3>(planes).first(part.tables.planes.size() + 1));
    draw_best(first, part.look_up, {&w(), &part.sigma_m, &part.normal, &part.w});
  }
  glDisable(GL_DEPTH_TEST);
}

void BackgroundPass::find_color() {
  bool first = true;
  for (const Part& part : parts_) {
    if (!part.has_color) continue;
    if (several_) keep_best(first);
    part.find_color.program.use();
    set_uniform(part.find_color_at, std::span(part.face_from_camera).first(part.faces.size()));
    draw_best(std::exchange(first, false), part.find_color, {&w(), &part.w, &part.color});
  }
  glDisable(GL_DEPTH_TEST);
}

std::span<const glm::vec4> BackgroundPass::colors_of_places() {
  if (!has_color_ || place_colors_.empty()) return {};
  bind(at_places_.target);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glReadPixels(0, 0, static_cast<GLsizei>(place_colors_.size()), 1, GL_RGBA, GL_FLOAT,
               place_colors_.data());
  return place_colors_;
}

}  // namespace mixrig::render::gles
