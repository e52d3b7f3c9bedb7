// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/background_pass.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace mixrig::render::gles {
Result<BackgroundPass> BackgroundPass::create(const Tables& tables, const CompositorSetup& setup,
                                              std::span<const ExposureMeter::Place> places) {
  BackgroundPass pass;
  const ModelTables model = make_model_tables(setup, !setup.objects.empty());
  MIXRIG_ASSIGN(pass.warp_, WarpPass::create(model.grid));
  MIXRIG_TRY(pass.create_faces(setup, model));
  pass.depth_m_ = make_texture(tables.view_size, GL_R32F);
  pass.spread_m_ = make_texture(tables.view_size, GL_R32F);
  pass.normal_ = make_texture(tables.view_size, GL_RGBA16F);
  pass.row_w_ = make_texture(tables.view_size, GL_R32F);
  pass.limit_w_ = make_texture(tables.view_size, GL_R32F);
  MIXRIG_TRY(pass.create_model(setup, model));
  MIXRIG_TRY(pass.create_limit(setup, model.limit_radius_px));
  pass.set_view(pass.look_up_, tables, model, pass.look_up_at_);
  if (!pass.has_color_) return pass;
  pass.set_view(pass.color_, tables, model, pass.color_at_);
  pass.color_.program.set("color_factor", pass.color_factor_);
  pass.color_.program.set("most_spread", kMostColorSpread);
  Image<glm::vec2> at({static_cast<int>(places.size()), 1});
  for (std::size_t i = 0; i < places.size(); ++i)
    at.row(0)[i] = glm::vec2(places[i].view_x, places[i].view_y);
  pass.places_ = make_texture(at.view(), GL_RG32F);
  pass.place_color_ = make_texture(at.size(), GL_RGBA32F);
  pass.place_colors_.resize(places.size());
  MIXRIG_ASSIGN(pass.at_places_, make_step("background_places.frag", {&pass.place_color_}));
  return pass;
}

Result<void> BackgroundPass::create_faces(const CompositorSetup& setup, const ModelTables& model) {
  MIXRIG_ASSIGN(correct_, CorrectPass::create(model.grid));
  const auto& poses = setup.background_model->world_from_face;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Face& face = faces_.emplace_back();
    face.world_from_face = poses[i];
    face.vertices = make_texture(model.grid.tof_size, correct_.vertices().internal_format);
    MIXRIG_ASSIGN(face.target, make_target({&face.vertices}));
    correct_.upload_depth(model.depth_m[i]);
    correct_.draw_into(face.target);
  }
  return {};
}

Result<void> BackgroundPass::create_model(const CompositorSetup& setup, const ModelTables& model) {
  const BackgroundModel& from = *setup.background_model;
  const Size size = from.depth_m.size;
  GLint most_px = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most_px);
  const Size largest = from.color.empty() ? size : from.color.size;
  if (std::max(largest.width, largest.height) > most_px)
    return Error{
        ErrorCode::kUnsupported,
        fmt::format("the background's pictures are {}x{}, this GPU takes up to {} pixels a "
                    "side: use the cpu back end or a smaller background",
                    largest.width, largest.height, most_px)};
  const Image<float> zeros(size, 0.0F);
  model_w_ = make_texture(model.w.view(), GL_R32F);
  model_sigma_m_ =
      make_texture(from.depth_sigma_m.empty() ? zeros.view() : from.depth_sigma_m, GL_R32F);
  const Image<PackedNormal> unknown(size, PackedNormal{});
  model_normal_ =
      make_texture(model.normal.empty() ? unknown.view() : model.normal.view(), GL_RGBA8_SNORM);
  MIXRIG_ASSIGN(look_up_, make_step("background.frag", {&depth_m_, &spread_m_, &normal_}));
  has_color_ = !from.color.empty();
  if (!has_color_) return {};
  model_color_ = make_texture(from.color, GL_SRGB8_ALPHA8, Sampling::kLinear);
  color_factor_ = from.color_factor;
  learned_ = make_texture(depth_m_.size, GL_RGBA16F);
  learned_sigma_ = make_texture(depth_m_.size, GL_R16F);
  MIXRIG_ASSIGN(color_, make_step("background_color.frag", {&learned_, &learned_sigma_}));
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

void BackgroundPass::set_view(const Step& step, const Tables& tables, const ModelTables& model,
                              Placing& placing) {
  step.program.set("focal_px", tables.warp.view.focal_px);
  step.program.set("center_px", tables.warp.view.center_px);
  step.program.set("model_focal_px", model.camera.focal_px);
  step.program.set("model_center_px", model.camera.center_px);
  step.program.set("faces", static_cast<int>(faces_.size()));
  step.program.set("face_rows", model.face_rows);
  placing.face_from_camera = step.program.location("face_from_camera");
}

void BackgroundPass::draw(const geometry::Pose& world_from_camera) {
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const FacePose pose = face_pose(faces_[i].world_from_face, world_from_camera);
    face_from_camera_[i] = pose.face_from_camera;
    warp_.set_pose(pose.camera_from_face);
    if (i == 0)
      warp_.draw(faces_[i].vertices, correct_.tof_ray());
    else
      warp_.add(faces_[i].vertices, correct_.tof_ray());
  }
  const std::span<const glm::mat4> face_from_camera(face_from_camera_.data(), faces_.size());
  look_up_.program.use();
  set_uniform(look_up_at_.face_from_camera, face_from_camera);
  run(look_up_, {&warp_.w(), &model_sigma_m_, &model_normal_});
  run(rows_, {&warp_.w()});
  run(limit_, {&row_w_, &depth_m_, &spread_m_});
  if (!has_color_) return;
  color_.program.use();
  set_uniform(color_at_.face_from_camera, face_from_camera);
  run(color_, {&warp_.w(), &model_w_, &model_color_});
  run(at_places_, {&places_, &learned_});
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
