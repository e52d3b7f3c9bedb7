// SPDX-License-Identifier: Apache-2.0
// The background of a run, with the changes that were accepted into it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/render/contract/compositor.h"
#include "host/room/background/static_background.h"
#include "host/room/scan/shape/room_faces.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Models from which a session's background is drawn. They borrow from the session and from
/// `color`, which is filled for a camera that stands still at `world_from_view`. Empty if the
/// session has no background.
std::vector<render::BackgroundModel> models_of(const Session& session,
                                               const geometry::Pose& world_from_view,
                                               Image<Rgbx8>& color);

/// Copies of a session's pictures of the room, and a setup that refers to them. Not movable.
struct KeptBackground {
  explicit KeptBackground(const Session& session);
  /// Copies `from` completely.
  KeptBackground(const KeptBackground& from);
  KeptBackground& operator=(const KeptBackground&) = delete;

  std::vector<model::RoomFaces> rooms;
  std::optional<model::StaticBackground> view;  ///< learned in one view
  Image<Rgbx8> view_color;                      ///< learned_color() of `view`
  render::CompositorSetup setup;

  /// Replaces `view` by another one from the same place. Precondition: there is one.
  void replace_view(model::StaticBackground learned);
  /// The models to draw; for a camera that stands still at `world_from_view`, its single view.
  std::vector<render::BackgroundModel> models(const geometry::Pose& world_from_view) const;

 private:
  void see();
};

/// Depth of one pixel of the room that is learned again; 0: unknown.
struct KeptPixel {
  float depth_m = 0, depth_sigma_m = 0;
};
/// Colour of one pixel of the room; red negative: unknown.
struct KeptColor {
  Rgbf color{-1, -1, -1};
  float spread = 0;
};

/// Sets the depth of a pixel of model `model` (index as in models()); rows run over all faces.
void set_depth(KeptBackground& background, std::size_t model, int x, int row, KeptPixel pixel);
/// Sets a pixel (`x`, `row`) of a model's colour picture, which is finer by color_factor.
void set_color(KeptBackground& background, std::size_t model, int x, int row,
               const KeptColor& pixel);

}  // namespace mixrig::session
