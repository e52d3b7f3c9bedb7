// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/room_sight.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "host/render/cpu/background/background.h"
#include "host/run/session/kept_background.h"

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

/// Pinhole with the field of view of `view` and pixels no finer than those of `camera`.
geometry::Pinhole as_fine_as(const geometry::Pinhole& camera, geometry::Pinhole view) {
  const double scale = std::min(1.0, camera.fx_px / view.fx_px);
  view.size_px = {std::max(1, static_cast<int>(std::lround(view.size_px.width * scale))),
                  std::max(1, static_cast<int>(std::lround(view.size_px.height * scale)))};
  view.fx_px *= scale, view.fy_px *= scale;
  view.cx_px = (view.cx_px + 0.5) * scale - 0.5, view.cy_px = (view.cy_px + 0.5) * scale - 0.5;
  return view;
}

/// Depth of the empty room in a view.
class RoomDepth {
 public:
  RoomDepth(const Session& session, const SeenFrom& from, const geometry::Pinhole& view)
      : models_(models_of(session, from.world_from_view, color_)), setup_(session.setup) {
    if (!known()) return;
    setup_.view = view;
    setup_.tof = {view, {}};  // no finer than the picture
    setup_.background = {};
    setup_.background_models = models_;
    drawn_.emplace(crew_, setup_, render::cpu::DrawnFor::kPictures);
    drawn_->draw(crew_, from.world_from_view);
  }
  bool known() const { return !models_.empty(); }
  ImageView<const float> depth_m() const { return drawn_->view().depth_m; }

 private:
  Image<Rgbx8> color_;
  std::vector<render::BackgroundModel> models_;
  render::CompositorSetup setup_;
  Crew crew_{1};
  std::optional<render::cpu::MovingBackground> drawn_;
};

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
    return Error{ErrorCode::kData,
                 level_m == 0 ? "there is no floor where you clicked"
                              : "nothing at that height lies in line with your click: give "
                                "another height"};
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
  const Eigen::Vector2d px = pixel_at(from, at);
  RoomDepth room(session, from, window_around(from.view, px));
  if (!room.known())
    return Error{ErrorCode::kUnsupported, "this run knows no surfaces of the room: give a height"};
  const float z_m = nearest_known_m(room.depth_m());
  if (!(z_m > 0))
    return Error{ErrorCode::kData,
                 "no surface of the room is known where you clicked: give a height"};
  const Eigen::Vector2d ray = from.view.unproject(px);
  return from.world_from_view * Vector3d(Vector3d(ray.x(), ray.y(), 1) * double{z_m});
}

Result<model::ClickedPlane> plane_on_room(const Session& session, const SeenFrom& from,
                                          const Eigen::Vector2d& at) {
  const geometry::CameraModel tof{as_fine_as(session.setup.tof.pinhole, from.view), {}};
  RoomDepth room(session, from, tof.pinhole);
  if (!room.known())
    return Error{ErrorCode::kUnsupported,
                 "this run knows no surfaces of the room on which an object could stand"};
  model::ClickPicture picture;
  picture.depth_m = room.depth_m();
  picture.tof = &tof;
  picture.noise = session.setup.noise;
  picture.view = from.view;
  auto found = model::plane_under(picture, {pixel_at(from, at), std::nullopt});
  if (const auto* refusal = std::get_if<model::ClickRefusal>(&found))
    return Error{ErrorCode::kData,
                 "nothing can stand there: " + std::string(model::text_of(*refusal))};
  return std::move(std::get<model::ClickedPlane>(found));
}

}  // namespace mixrig::session
