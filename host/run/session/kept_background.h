// SPDX-License-Identifier: Apache-2.0
// The background of a run with the changes that were accepted into it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/render/contract/compositor.h"
#include "host/room/background/static_background.h"
#include "host/room/scan/shape/room_faces.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// What a session's background is drawn from, borrowed from it and from `color`, which is filled
/// for a camera that stands still at `world_from_view`. None where the session has none.
std::vector<render::BackgroundModel> models_of(const Session& session,
                                               const geometry::Pose& world_from_view,
                                               Image<Rgbx8>& color);

/// Copies of a session's pictures of the room, and a setup that sees them. Not movable.
struct KeptBackground {
  explicit KeptBackground(const Session& session);
  /// A copy of `from`, which may go.
  KeptBackground(const KeptBackground& from);
  KeptBackground& operator=(const KeptBackground&) = delete;

  std::vector<model::RoomFaces> rooms;
  std::optional<model::StaticBackground> view;  ///< learned in one view
  Image<Rgbx8> view_color;                      ///< of `view`, learned_color()
  render::CompositorSetup setup;

  /// Another view of the room in place of `view`, from the same place. Precondition: there is one.
  void replace_view(model::StaticBackground learned);
  /// The models that are drawn; of a camera that stands still at `world_from_view` its one view.
  std::vector<render::BackgroundModel> models(const geometry::Pose& world_from_view) const;

 private:
  void see();
};

/// One pixel of the room that is learned again. Depth 0: unknown.
struct KeptPixel {
  float depth_m = 0, depth_sigma_m = 0;
};
/// A colour; red negative: unknown.
struct KeptColor {
  Rgbf color{-1, -1, -1};
  float spread = 0;
};

/// Sets a pixel of model `model` (as models()), rows counted over all faces.
void set_depth(KeptBackground& background, std::size_t model, int x, int row, KeptPixel pixel);
/// The same of its colour, whose pixels are finer by color_factor.
void set_color(KeptBackground& background, std::size_t model, int x, int row,
               const KeptColor& pixel);

}  // namespace mixrig::session
