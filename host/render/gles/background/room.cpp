// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/background/room.h"

#include "host/render/tables/background_model.h"

namespace mixrig::render::gles {

Result<Room> Room::create(const CompositorSetup& setup, Tables& tables,
                          std::span<const ExposureMeter::Place> places) {
  Room room;
  if (!setup.background_models.empty()) {
    MIXRIG_ASSIGN(room.drawn_, BackgroundPass::create(tables, setup, places));
    tables.has_background = true;
    const bool color = has_model_color(setup);
    room.has_color_ = {color, color};
    return room;
  }
  const BackgroundView& learned = setup.background;
  room.has_color_ = {!learned.color.empty(), !learned.color_sigma.empty()};
  room.has_depth_ = tables.has_background;
  if (!room.has_depth_) return room;
  room.depth_m_ = make_texture(
      tables.edge_depth_m.empty() ? learned.depth_m : tables.edge_depth_m.view(), GL_R32F);
  if (setup.may_hide_objects && !tables.edge_depth_m.empty())
    room.learned_m_ = make_texture(learned.depth_m, GL_R32F);
  if (!tables.light_depth_m.empty())
    room.light_m_ = make_texture(tables.light_depth_m.view(), GL_R32F);
  if (!learned.color.empty()) room.color_ = make_texture(learned.color, GL_RGB16F);
  if (!learned.color_sigma.empty()) room.color_sigma_ = make_texture(learned.color_sigma, GL_R16F);
  return room;
}

void Room::set_view(const Tables& tables, const CompositorSetup& setup) {
  if (drawn_) drawn_->set_view(tables, setup);
}

void Room::draw(const geometry::Pose& world_from_camera, bool with_light, ExposureMeter& meter,
                StageTimer& timer) {
  if (!drawn_) return;
  const StageScope stage(timer, Stage::kBackground);
  drawn_->draw(world_from_camera, with_light);
  meter.learn(drawn_->colors_of_places());
}

}  // namespace mixrig::render::gles
