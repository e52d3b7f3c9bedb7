// SPDX-License-Identifier: Apache-2.0
// Textures of the real room behind people: learned once, or drawn for each pose from its models.
#pragma once

#include <optional>
#include <span>

#include "host/render/frame/exposure.h"
#include "host/render/gles/background/background_pass.h"
#include "host/render/gles/gl/stage_timer.h"
#include "host/render/gles/key/key_pass.h"

namespace mixrig::render::gles {

/// Used by one compositor. Textures are empty where the scene has no such image.
class Room {
 public:
  Room() = default;
  /// Creates the textures and sets tables.has_background. Errors: those of BackgroundPass.
  static Result<Room> create(const CompositorSetup& setup, Tables& tables,
                             std::span<const ExposureMeter::Place> places);
  /// Sets another view of the same size.
  void set_view(const Tables& tables, const CompositorSetup& setup);
  /// Draws the models for a pose and gives `meter` their colours; does nothing for a background
  /// that was learned once. `with_light`: the frame shows objects.
  void draw(const geometry::Pose& world_from_camera, bool with_light, ExposureMeter& meter,
            StageTimer& timer);

  bool is_drawn() const { return drawn_.has_value(); }
  LearnedColor has_color() const { return has_color_; }
  /// Depth of the background. With objects, a depth that was learned once has its steps at colour
  /// edges.
  const Texture& depth_m(bool has_objects) const {
    if (drawn_) return drawn_->depth_m();
    return has_objects || learned_m_.size.empty() ? depth_m_ : learned_m_;
  }
  /// Depth of the surface on which light is computed; null if there is none.
  const Texture* light_m() const {
    return drawn_ ? &drawn_->light_m() : has_depth_ ? &light_m_ : nullptr;
  }
  const Texture& color() const { return drawn_ ? drawn_->learned() : color_; }
  const Texture& color_sigma() const { return drawn_ ? drawn_->learned_sigma() : color_sigma_; }
  /// Normals and key limit of this frame; null: those of the take hold.
  const Texture* normal() const { return drawn_ ? &drawn_->normal() : nullptr; }
  const Texture* limit_w() const { return drawn_ ? &drawn_->limit_w() : nullptr; }

 private:
  bool has_depth_ = false;
  LearnedColor has_color_;
  Texture depth_m_, light_m_, color_, color_sigma_;
  Texture learned_m_;  ///< depth as learned, if frames with objects use another one
  std::optional<BackgroundPass> drawn_;
};

}  // namespace mixrig::render::gles
