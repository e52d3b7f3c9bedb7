// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/place.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/clock.h"
#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"
#include "host/run/session/camera_pose.h"
#include "host/scene/scene_edit.h"

namespace mixrig::session {
namespace {

using Eigen::Vector3d;

Result<const scene::Object*> object_of(const scene::Scene& scene, const std::string& name) {
  std::string names;
  for (const scene::Object& object : scene.objects) {
    if (object.name == name) return &object;
    names += (names.empty() ? "" : ", ") + object.name;
  }
  if (name.empty() && scene.objects.size() == 1) return &scene.objects.front();
  return Error{ErrorCode::kUsage,
               scene.path.string() + (scene.objects.empty() ? ": has no object: add an [[object]]"
                                      : name.empty()
                                          ? ": has several objects: give --object, one of " + names
                                          : ": has no object \"" + name + "\": it has " + names)};
}

/// A ready session and the capture of the frame.
Result<std::unique_ptr<Session>> session_at(const PlaceOptions& options,
                                            capture::Capture& capture) {
  MIXRIG_ASSIGN(auto session, open_session(options.session));
  static const SystemClock clock;
  const bool on_floor = session->scene.pose_source == scene::PoseSource::kFloor;
  if (on_floor) MIXRIG_TRY(prepare_background(*session, {}));
  MIXRIG_TRY(prepare_poses(*session, clock));
  const int frames = session->source->info().frames;
  if (options.frame < 1 || options.frame > frames)
    return Error{ErrorCode::kUsage,
                 fmt::format("--frame {}: the source has frames 1 to {}", options.frame, frames)};
  MIXRIG_ASSIGN(const bool there, session->source->read(options.frame, capture));
  if (!there || capture.depth_m.empty())
    return Error{ErrorCode::kData,
                 fmt::format("frame {} has no depth: give another --frame", options.frame)};
  return session;
}

model::ClickPicture picture_of_click(const Session& session, const capture::Capture& capture) {
  const render::CompositorSetup& setup = session.setup;
  model::ClickPicture picture;
  picture.depth_m = capture.depth_m;
  picture.tof = &setup.tof, picture.depth_is_distance = setup.depth_is_distance;
  picture.noise = setup.noise;
  picture.view =
      capture.lens ? render::view_through(setup, capture.lens->state.camera.pinhole) : setup.view;
  picture.view_from_tof = setup.target_from_tof;
  return picture;
}

/// The plate with the plane's part in green, as the depth camera sees it.
Result<void> draw_placement(const model::ClickPicture& picture, const model::ClickedPlane& plane,
                            Image<Rgb8> plate, const geometry::CameraModel& target,
                            const std::filesystem::path& path) {
  for (int y = 0; y < plane.region.height(); ++y)
    for (int x = 0; x < plane.region.width(); ++x) {
      const auto ray = plane.region.at(x, y) != 0 ? picture.tof->unproject({x, y}) : std::nullopt;
      if (!ray) continue;
      Vector3d p(ray->x(), ray->y(), 1);
      p *= picture.depth_m.at(x, y) / (picture.depth_is_distance ? p.norm() : 1.0);
      const auto px = target.project(picture.view_from_tof * p);
      if (!px) continue;
      const int u = static_cast<int>(std::lround(px->x())),
                v = static_cast<int>(std::lround(px->y()));
      if (u < 0 || v < 0 || u >= plate.width() || v >= plate.height()) continue;
      Rgb8& at = plate.at(u, v);
      at.g = static_cast<std::uint8_t>(128 + at.g / 2);
    }
  return image_io::write_png(path, plate);
}

}  // namespace

Eigen::Quaterniond rotation_on_plane(const Vector3d& normal, const Vector3d& sight,
                                     double turn_rad) {
  const Vector3d ahead =
      std::abs(normal.z()) < std::sqrt(0.5) ? Vector3d(Vector3d::UnitZ()) : sight;
  Vector3d y = ahead - ahead.dot(normal) * normal;
  if (!(y.norm() > 1e-9)) y = normal.unitOrthogonal();
  y.normalize();
  Eigen::Matrix3d axes;
  axes << y.cross(normal), y, normal;
  return Eigen::Quaterniond(axes) *
         Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()));
}

geometry::Pose pose_on_plane(const scene::Object& object, const model::ClickedPlane& plane,
                             const geometry::Pose& world_from_view, double turn_rad,
                             const Eigen::Vector2d& slide_m) {
  const Vector3d normal = world_from_view.rotation * plane.plane.normal;
  const Vector3d sight = world_from_view.rotation * plane.point_m.normalized();
  const double lowest_m = object.scale * static_cast<double>(scene::bounds(object.model).min_m.z());
  geometry::Pose pose;
  pose.rotation = rotation_on_plane(normal, sight, turn_rad);
  pose.translation_m = world_from_view * plane.point_m - lowest_m * normal +
                       rotation_on_plane(normal, sight, 0) * Vector3d(slide_m.x(), slide_m.y(), 0);
  return pose;
}

Result<Placement> place_object(const PlaceOptions& options) {
  capture::Capture capture;
  MIXRIG_ASSIGN(const auto session, session_at(options, capture));
  MIXRIG_ASSIGN(const scene::Object* object, object_of(session->scene, options.object));
  const model::ClickPicture picture = picture_of_click(*session, capture);
  auto found = model::plane_under(picture, options.click);
  if (const auto* refusal = std::get_if<model::ClickRefusal>(&found)) {
    const char* by_rect = *refusal == model::ClickRefusal::kNotFlat
                              ? "; if the depth is noisy, give a larger area by --rect W,H"
                              : "";
    return Error{ErrorCode::kData, fmt::format("pixel {:.0f},{:.0f}: nothing can stand there: {}{}",
                                               options.click.px.x(), options.click.px.y(),
                                               model::text_of(*refusal), by_rect)};
  }
  Placement placement;
  placement.object = object->name;
  placement.plane = std::move(std::get<model::ClickedPlane>(found));
  placement.world_from_view = session->world_from_target(capture);
  placement.world_from_object = pose_on_plane(*object, placement.plane, placement.world_from_view,
                                              options.turn_rad, options.slide_m);
  if (!options.drawing.empty())
    MIXRIG_TRY(draw_placement(picture, placement.plane, capture.plate, session->setup.target,
                              options.drawing));
  return placement;
}

nlohmann::json to_json(const Placement& placement) {
  const geometry::Pose& pose = placement.world_from_object;
  const Eigen::Vector4d q = pose.rotation.coeffs();
  const Vector3d p = pose.translation_m;
  const Vector3d n = placement.world_from_view.rotation * placement.plane.plane.normal;
  return {{"object", placement.object},
          {"position_m", {p.x(), p.y(), p.z()}},
          {"rotation_xyzw", {q[0], q[1], q[2], q[3]}},
          {"normal", {n.x(), n.y(), n.z()}},
          {"normal_sigma_deg", placement.plane.normal_sigma_rad / kDeg},
          {"offset_sigma_mm", 1e3 * placement.plane.offset_sigma_m},
          {"residual", placement.plane.residual},
          {"points", placement.plane.points},
          {"area_m2", placement.plane.area_m2}};
}

Result<void> write_placement(const Placement& placement, const std::filesystem::path& scene) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(scene, kMostBytes));
  MIXRIG_ASSIGN(const std::string edited, scene::with_object_pose(text, scene, placement.object,
                                                                  placement.world_from_object));
  return write_file(scene, edited);
}

}  // namespace mixrig::session
