// SPDX-License-Identifier: Apache-2.0
// Pass background: the background model as the camera sees it from its pose.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/render/background_model.h"
#include "host/render/exposure.h"
#include "host/render/gles/correct_pass.h"
#include "host/render/gles/warp_pass.h"

namespace mixrig::render::gles {

/// View-sized textures; changed by draw().
class BackgroundPass {
 public:
  /// Precondition: setup.background_model is there. Errors: as make_program and make_target.
  static Result<BackgroundPass> create(const Tables& tables, const CompositorSetup& setup,
                                       std::span<const ExposureMeter::Place> places);
  void draw(const geometry::Pose& world_from_camera);
  /// Learned colour of each place in order, linear, red negative where unknown. Waits for the GPU.
  std::span<const glm::vec4> colors_of_places();

  const Texture& depth_m() const { return depth_m_; }  ///< GL_R32F, 0 unknown
  const Texture& limit_w() const { return limit_w_; }  ///< GL_R32F, kNoLimitW where unknown
  const Texture& normal() const { return normal_; }    ///< GL_RGBA16F, camera axes, 0 unknown
  /// GL_RGBA16F, red negative where unknown, and GL_R16F; no textures without colour.
  const Texture& learned() const { return learned_; }
  const Texture& learned_sigma() const { return learned_sigma_; }

 private:
  struct Placing {  ///< uniforms of common/model.glsl
    GLint face_from_camera = -1;
  };
  struct Face {
    geometry::Pose world_from_face;
    Texture vertices;
    Target target;
  };
  Result<void> create_faces(const CompositorSetup& setup, const ModelTables& model);
  Result<void> create_model(const CompositorSetup& setup, const ModelTables& model);
  Result<void> create_limit(const CompositorSetup& setup, int radius_px);
  void set_view(const Step& step, const Tables& tables, const ModelTables& model, Placing& placing);

  std::vector<Face> faces_;
  std::array<glm::mat4, kMostFaces> face_from_camera_;  ///< of the last draw
  CorrectPass correct_;
  WarpPass warp_;
  Texture model_w_, model_sigma_m_, model_normal_, model_color_, places_;
  Texture depth_m_, spread_m_, normal_, learned_, learned_sigma_, row_w_, limit_w_, place_color_;
  Step look_up_, color_, rows_, limit_, at_places_;
  Placing look_up_at_, color_at_;
  bool has_color_ = false;
  int color_factor_ = 1;
  std::vector<glm::vec4> place_colors_;
};

}  // namespace mixrig::render::gles
