// SPDX-License-Identifier: Apache-2.0
#include "host/session/room_sight.h"

#include <cmath>

#include "host/render/cpu/background.h"
#include "host/session/kept_background.h"

namespace mixrig::session {
namespace {

using Eigen::Vector3d;

constexpr int kReach_px = 20;
constexpr int kSightWindow_px = 2 * kReach_px + 1;

Eigen::Vector2d pixel_at(const SeenFrom& from, const Eigen::Vector2d& at) {
  const Size size = from.view.size_px;
  return {at.x() * size.width - 0.5, at.y() * size.height - 0.5};
}

/// The part of the view around a pixel, which becomes its middle.
geometry::Pinhole window_around(geometry::Pinhole view, const Eigen::Vector2d& px) {
  view.size_px = {kSightWindow_px, kSightWindow_px};
  view.cx_px -= px.x() - kReach_px;
  view.cy_px -= px.y() - kReach_px;
  return view;
}

/// Depth of the known pixel that is nearest to the middle; 0: none is known.
float nearest_known_m(ImageView<const float> depth_m) {
  float found_m = 0;
  int least = kReach_px * kReach_px + 1;
  for (int y = 0; y < depth_m.size.height; ++y)
    for (int x = 0; x < depth_m.size.width; ++x) {
      const int dx = x - kReach_px, dy = y - kReach_px;
      if (!(depth_m.row(y)[x] > 0) || dx * dx + dy * dy >= least) continue;
      least = dx * dx + dy * dy;
      found_m = depth_m.row(y)[x];
    }
  return found_m;
}

}  // namespace

Result<Vector3d> point_on_level(const SeenFrom& from, const Eigen::Vector2d& at, double level_m) {
  constexpr double kFarthest_m = 100;
  const Eigen::Vector2d ray = from.view.unproject(pixel_at(from, at));
  const Vector3d sight = from.world_from_view.rotation * Vector3d(ray.x(), ray.y(), 1);
  const Vector3d& eye = from.world_from_view.translation_m;
  const double along = (level_m - eye.z()) / sight.z();
  if (!(along > 0) || !(along * sight.norm() < kFarthest_m))
    return Error{ErrorCode::kData, level_m == 0
                                       ? "there is no floor under this place of the picture"
                                       : "the sight through this place of the picture does not "
                                         "reach that height: give another one"};
  const Vector3d p = eye + along * sight;
  return Vector3d(p.x(), p.y(), level_m);  // without what rounding left of z
}

std::optional<Eigen::Vector2d> place_in_picture(const SeenFrom& from, const Vector3d& p_world) {
  const Vector3d p = inverse(from.world_from_view) * p_world;
  if (!(p.z() > 1e-3)) return std::nullopt;
  const Eigen::Vector2d px = from.view.project(p);
  const Size size = from.view.size_px;
  const Eigen::Vector2d at((px.x() + 0.5) / size.width, (px.y() + 0.5) / size.height);
  if (!at.allFinite() || at.minCoeff() < 0 || at.maxCoeff() > 1) return std::nullopt;
  return at;
}

Result<Vector3d> point_on_room(const Session& session, const SeenFrom& from,
                               const Eigen::Vector2d& at) {
  Image<Rgbx8> color;
  const auto models = models_of(session, from.world_from_view, color);
  if (models.empty())
    return Error{ErrorCode::kUnsupported,
                 "this run knows no room whose surface could be seen there: give a height"};
  const Eigen::Vector2d px = pixel_at(from, at);
  render::CompositorSetup setup = session.setup;
  setup.view = window_around(from.view, px);
  setup.tof = {setup.view, {}};  // no finer than the picture
  setup.background = {};
  setup.background_models = models;
  render::Tables tables;
  tables.view_size = setup.view.size_px;
  tables.key_limit_w.reset(setup.view.size_px);
  Crew crew(1);
  render::cpu::MovingBackground room(crew, setup, render::cpu::Normals::kSkip);
  room.draw(crew, from.world_from_view, tables);
  const float z_m = nearest_known_m(room.view().depth_m);
  if (!(z_m > 0))
    return Error{ErrorCode::kData, "no surface of the room is known there: give a height"};
  const Eigen::Vector2d ray = from.view.unproject(px);
  return from.world_from_view * Vector3d(Vector3d(ray.x(), ray.y(), 1) * double{z_m});
}

}  // namespace mixrig::session
