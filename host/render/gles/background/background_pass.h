// SPDX-License-Identifier: Apache-2.0
// Pass background: draws the background models as the camera sees them from its pose.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/render/frame/exposure.h"
#include "host/render/gles/plate/correct_pass.h"
#include "host/render/gles/warp/warp_pass.h"
#include "host/render/tables/background_model.h"

namespace mixrig::render::gles {

/// The results are textures of the view's size, which draw() rewrites.
class BackgroundPass {
 public:
  /// Precondition: setup.background_models is not empty. Errors: those of make_program and
  /// make_target.
  static Result<BackgroundPass> create(const Tables& tables, const CompositorSetup& setup,
                                       std::span<const ExposureMeter::Place> places);
  /// Sets the view of the next draw from `setup` and `tables`; its size must not change.
  void set_view(const Tables& tables, const CompositorSetup& setup);
  /// Draws all models. Without `with_light` the frame shows no objects, and wrapped depth is kept
  /// as it is.
  void draw(const geometry::Pose& world_from_camera, bool with_light);
  /// Learned linear colour of each place in order; red is negative where unknown. Waits for the
  /// GPU.
  std::span<const glm::vec4> colors_of_places();

  const Texture& depth_m() const { return depth_m_; }  ///< GL_R32F, 0 unknown
  /// Depth of the surface on which light is computed, GL_R32F, metres, 0 unknown.
  const Texture& light_m() const { return light_m_; }
  const Texture& limit_w() const { return limit_w_; }  ///< GL_R32F, kNoLimitW where unknown
  const Texture& normal() const { return normal_; }    ///< GL_RGBA16F, camera axes, 0 unknown
  /// Learned colour, GL_RGBA16F, red negative where unknown, and its sigma, GL_R16F; empty textures
  /// without colour.
  const Texture& learned() const { return learned_; }
  const Texture& learned_sigma() const { return learned_sigma_; }

 private:
  struct Face {
    geometry::Pose world_from_face;
    Texture vertices;
    Target target;
  };
  /// The passes and tables of one background model.
  struct Part {
    std::vector<Face> faces;
    std::array<FacePose, kMostFaces> pose{};               ///< of the last draw
    std::array<glm::mat4, kMostFaces> face_from_camera{};  ///< of the last draw
    ModelTables tables;                                    ///< without images, which are on the GPU
    CorrectPass correct;
    WarpPass warp;
    Texture w, sigma_m, normal, color;
    Step look_up, find_color;
    /// Location of face_from_camera (common/model.glsl).
    GLint look_up_at = -1, find_color_at = -1;
    GLint planes_at = -1;
    bool has_color = false;
  };
  Result<void> add_part(const Tables& tables, const BackgroundModel& from,
                        const ModelTables& model);
  static Result<void> create_faces(const BackgroundModel& from, const ModelTables& model,
                                   Part& part);
  Result<void> create_look_ups(const Tables& tables, const BackgroundModel& from,
                               const ModelTables& model, Part& part);
  Result<void> create_limit(const CompositorSetup& setup, int radius_px);
  Result<void> create_places(std::span<const ExposureMeter::Place> places);
  void draw_surfaces(const geometry::Pose& world_from_camera);
  void look_up(bool with_light);
  void find_color();
  const Texture& w() const { return parts_.front().warp.w(); }
  const Texture* choice() const { return several_ ? &choice_ : nullptr; }

  std::vector<Part> parts_;
  bool several_ = false;
  Texture depth_m_, light_m_, spread_m_, normal_, learned_, learned_sigma_, row_w_, limit_w_;
  Texture choice_;  ///< with several models: how well the model of each pixel saw its surface
  Texture places_, place_color_;
  Step rows_, limit_, at_places_;
  bool has_color_ = false;
  std::vector<glm::vec4> place_colors_;
};

}  // namespace mixrig::render::gles
