// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/plan_room.h"

#include <algorithm>
#include <cmath>

#include "host/run/session/kept_background.h"

namespace mixrig::session {
namespace {

constexpr int kMostWidth_px = 160;  ///< of the room's depth: points are never sparser

void add_points(const render::BackgroundModel& model, std::vector<plan::RoomPoint>& points) {
  const Size size = model.camera.size_px;
  const int factor = model.color_factor;
  for (std::size_t f = 0; f < model.world_from_face.size(); ++f)
    for (int y = 0; y < size.height; ++y) {
      const int row = static_cast<int>(f) * size.height + y;
      for (int x = 0; x < size.width; ++x) {
        const float z = model.depth_m.at(x, row);
        if (!(z > 0)) continue;
        const Eigen::Vector2d ray = model.camera.unproject({x, y});
        const Eigen::Vector3d at =
            model.world_from_face[f] * (double{z} * Eigen::Vector3d(ray.x(), ray.y(), 1));
        Rgb8 color{160, 160, 160};
        if (!model.color.empty()) {
          const Rgbx8& c = model.color.at(x * factor + factor / 2, row * factor + factor / 2);
          color = {c.r, c.g, c.b};
        }
        points.push_back({at.cast<float>(), color});
      }
    }
}

}  // namespace

std::vector<plan::RoomPoint> room_points(const Session& session,
                                         const geometry::Pose& world_from_camera) {
  std::vector<plan::RoomPoint> points;
  Image<Rgbx8> color;
  const geometry::Pose& place = session.background && session.background->world_from_view
                                    ? *session.background->world_from_view
                                    : world_from_camera;
  for (const render::BackgroundModel& model : models_of(session, place, color))
    add_points(model, points);
  return points;
}

plan::RoomView view_of_room(const std::vector<plan::RoomPoint>& points,
                            const geometry::Pinhole& view, const geometry::Pose& world_from_camera,
                            Image<float>& depth_m) {
  const int width = std::min(view.size_px.width, kMostWidth_px);
  const geometry::Pinhole small =
      resized(view, {width, std::max(1, width * view.size_px.height / view.size_px.width)});
  depth_m.reset(small.size_px);
  const geometry::Pose camera_from_world = geometry::inverse(world_from_camera);
  for (const plan::RoomPoint& p : points) {
    const Eigen::Vector3d at = camera_from_world * p.at_m.cast<double>();
    if (at.z() < 0.1) continue;
    const Eigen::Vector2d px = small.project(at);
    const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
    if (x < 0 || y < 0 || x >= depth_m.width() || y >= depth_m.height()) continue;
    float& z = depth_m.at(x, y);
    if (z == 0 || at.z() < z) z = static_cast<float>(at.z());
  }
  return {depth_m, small, world_from_camera};
}

}  // namespace mixrig::session
