// SPDX-License-Identifier: Apache-2.0
// The real room behind people as textures: learned once, or drawn for each pose from its models.
#pragma once

#include <optional>
#include <span>

#include "host/render/frame/exposure.h"
#include "host/render/gles/background/background_pass.h"
#include "host/render/gles/gl/stage_timer.h"
#include "host/render/gles/key/key_pass.h"

namespace mixrig::render::gles {

/// Memory of one compositor. Textures are empty where the scene has no such image.
class Room {
 public:
  Room() = default;
  /// Sets tables.has_background. Errors: those of BackgroundPass.
  static Result<Room> create(const CompositorSetup& setup, Tables& tables,
                             std::span<const ExposureMeter::Place> places);
  /// Another view of the same size.
  void set_view(const Tables& tables, const CompositorSetup& setup);
  /// Draws the models for a pose, and `meter` learns their colours; not where it was learned once.
  /// `with_light`: the frame shows objects.
  void draw(const geometry::Pose& world_from_camera, bool with_light, ExposureMeter& meter,
            StageTimer& timer);

  bool is_drawn() const { return drawn_.has_value(); }
  LearnedColor has_color() const { return has_color_; }
  /// Where a frame has objects, steps of what was learned once are those of its colours.
  const Texture& depth_m(bool has_objects) const {
    if (drawn_) return drawn_->depth_m();
    return has_objects || learned_m_.size.empty() ? depth_m_ : learned_m_;
  }
  /// The surface that light falls on; null where there is none.
  const Texture* light_m() const {
    return drawn_ ? &drawn_->light_m() : has_depth_ ? &light_m_ : nullptr;
  }
  const Texture& color() const { return drawn_ ? drawn_->learned() : color_; }
  const Texture& color_sigma() const { return drawn_ ? drawn_->learned_sigma() : color_sigma_; }
  /// Of this frame; null: those of the take.
  const Texture* normal() const { return drawn_ ? &drawn_->normal() : nullptr; }
  const Texture* limit_w() const { return drawn_ ? &drawn_->limit_w() : nullptr; }

 private:
  bool has_depth_ = false;
  LearnedColor has_color_;
  Texture depth_m_, light_m_, color_, color_sigma_;
  Texture learned_m_;  ///< depth as it was learned, where frames without objects have another
  std::optional<BackgroundPass> drawn_;
};

}  // namespace mixrig::render::gles
