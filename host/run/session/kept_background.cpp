// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/kept_background.h"

#include "hal/base/learned_color.h"

namespace mixrig::session {

KeptBackground::KeptBackground(const Session& session)
    : rooms(session.rooms), view(session.background), setup(session.setup) {
  if (view) view_color = learned_colors(view->color, view->color_sigma);
  see();
}

KeptBackground::KeptBackground(const KeptBackground& from)
    : rooms(from.rooms), view(from.view), view_color(from.view_color), setup(from.setup) {
  see();
}

std::vector<render::BackgroundModel> models_of(const Session& session,
                                               const geometry::Pose& world_from_view,
                                               Image<Rgbx8>& color) {
  if (!session.setup.background_models.empty()) return session.setup.background_models;
  if (!session.background) return {};
  const model::StaticBackground& b = *session.background;
  color = learned_colors(b.color, b.color_sigma);
  return {{b.view, {world_from_view}, b.depth_m, b.depth_sigma_m, color}};
}

/// Points the setup to the images; the order is that of session.cpp: rooms, then the view.
void KeptBackground::see() {
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    render::BackgroundModel& model = setup.background_models[i];
    model.depth_m = rooms[i].depth_m, model.depth_sigma_m = rooms[i].depth_sigma_m;
    model.color = rooms[i].color;
  }
  if (!view) return;
  if (setup.background_models.size() > rooms.size()) {
    render::BackgroundModel& model = setup.background_models.back();
    model.depth_m = view->depth_m, model.depth_sigma_m = view->depth_sigma_m;
    model.color = view_color;
  } else {
    setup.background = {view->depth_m, view->depth_sigma_m, view->color, view->color_sigma};
  }
}

void KeptBackground::replace_view(model::StaticBackground learned) {
  learned.world_from_view = view->world_from_view;
  view_color = learned_colors(learned.color, learned.color_sigma);
  view = std::move(learned);
  see();
}

std::vector<render::BackgroundModel> KeptBackground::models(
    const geometry::Pose& world_from_view) const {
  if (!setup.background_models.empty() || !view) return setup.background_models;
  return {{view->view, {world_from_view}, view->depth_m, view->depth_sigma_m, view_color}};
}

void set_depth(KeptBackground& background, std::size_t model, int x, int row, KeptPixel pixel) {
  const bool is_room = model < background.rooms.size();
  Image<float>& depth_m = is_room ? background.rooms[model].depth_m : background.view->depth_m;
  Image<float>& sigma_m =
      is_room ? background.rooms[model].depth_sigma_m : background.view->depth_sigma_m;
  depth_m.row(row)[x] = pixel.depth_m;
  sigma_m.row(row)[x] = pixel.depth_sigma_m;
}

void set_color(KeptBackground& background, std::size_t model, int x, int row,
               const KeptColor& pixel) {
  if (model < background.rooms.size()) {
    background.rooms[model].color.row(row)[x] = learned_color(pixel.color, pixel.spread);
    return;
  }
  background.view_color.row(row)[x] = learned_color(pixel.color, pixel.spread);
  background.view->color.row(row)[x] = pixel.color;
  background.view->color_sigma.row(row)[x] = pixel.spread;
}

}  // namespace mixrig::session
