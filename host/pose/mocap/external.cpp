// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/external.h"

#include <cmath>

#include "host/capture/calibration_file/calibration.h"
#include "host/math/config/table.h"
#include "host/math/estimation/markers/constellation.h"
#include "host/math/estimation/points/multilateration.h"

namespace mixrig::mocap {
namespace {

using Eigen::Vector3d;
using estimation::Estimate;
using geometry::Pose;

constexpr config::Range kPlace_m{-1e6, 1e6}, kNoise{1e-9, 1e3};

std::vector<Vector3d> points_of(const std::vector<config::Table>& tables, const char* key) {
  std::vector<Vector3d> points;
  for (const config::Table& table : tables) {
    const auto p = table.numbers(key, 3, 3, kPlace_m);
    if (p.size() == 3) points.emplace_back(p[0], p[1], p[2]);
  }
  return points;
}

std::optional<geometry::AnyCamera> parse_camera(const config::Table& table) {
  const auto size = table.numbers("size_px", 2, 2, {1, 16384});
  const auto focal = table.numbers("focal_px", 2, 2, config::kPositive);
  const auto centre = table.numbers("centre_px", 2, 2, {-1e5, 1e5});
  geometry::Lens::Coefficients lens{};
  if (table.has("lens")) {
    const auto k = table.numbers("lens", 4, lens.size(), {-1e3, 1e3});
    std::copy(k.begin(), k.end(), lens.begin());
  }
  if (size.size() != 2 || focal.size() != 2 || centre.size() != 2) return std::nullopt;
  const geometry::CameraModel camera{{{static_cast<int>(size[0]), static_cast<int>(size[1])},
                                      focal[0],
                                      focal[1],
                                      centre[0],
                                      centre[1]},
                                     geometry::Lens(lens)};
  if (const auto valid = geometry::validate(camera); !valid) table.fail("focal_px", valid.error());
  return geometry::AnyCamera(camera);
}

SeenMarker parse_marker(const config::Table& table) {
  SeenMarker marker;
  const auto p = table.numbers("world_m", 3, 3, kPlace_m);
  if (p.size() == 3) marker.world_m = {p[0], p[1], p[2]};
  if (table.has("pixel_px")) {
    const auto px = table.numbers("pixel_px", 2, 2, {-1e5, 1e5});
    if (px.size() == 2) marker.pixel_px = {px[0], px[1]};
  }
  marker.is_depth = table.has("depth_m");
  marker.measured_m = table.number(marker.is_depth ? "depth_m" : "distance_m", {1e-6, 1e6});
  if (marker.is_depth && !marker.pixel_px)
    table.fail("depth_m", "a depth needs a pixel_px, which gives its ray; else give distance_m");
  return marker;
}

/// A measured marker: distance, and bearing if it has a pixel.
struct Sight {
  double distance_m;
  std::optional<estimation::Bearing> bearing;
};

/// Converts a marker to a sight. A depth is z; the distance is along the ray of its pixel (Cortes
/// Reina 2015, eq. 90).
Result<Sight> sight_of(const SeenMarker& marker, const ExternalInput& input) {
  Sight sight{marker.measured_m, std::nullopt};
  if (marker.pixel_px) {
    if (!input.camera)
      return Error{ErrorCode::kFormat, "a marker has a pixel_px, but there is no [camera]: add it"};
    sight.bearing = std::visit(
        [&](const auto& camera) {
          return estimation::bearing_of(camera, *marker.pixel_px, input.sigma_px);
        },
        *input.camera);
    if (!sight.bearing || (marker.is_depth && !(sight.bearing->direction.z() > 0.01)))
      return Error{ErrorCode::kData, "the camera has no ray at pixel " +
                                         std::to_string(marker.pixel_px->x()) + ", " +
                                         std::to_string(marker.pixel_px->y())};
  }
  if (marker.is_depth && sight.bearing) sight.distance_m /= sight.bearing->direction.z();
  sight.distance_m += input.range_offset_m;
  if (!(sight.distance_m > 0))
    return Error{ErrorCode::kData,
                 "range_offset_m leaves a distance that is not positive: correct it"};
  return sight;
}

Estimate<Vector3d> centre_of_ranges(const ExternalInput& input, const std::vector<Sight>& sights,
                                    const Pose& world_from_body) {
  std::vector<Vector3d> centres;
  std::vector<double> ranges;
  for (const SeenMarker& marker : input.markers) centres.push_back(marker.world_m);
  for (const Sight& sight : sights) ranges.push_back(sight.distance_m);
  // If there are two mirrored solutions, the one near the camera's body is right.
  return estimation::multilaterate(centres, ranges,
                                   {input.sigma_range_m, world_from_body.translation_m});
}

Estimate<Vector3d> in_body(const Estimate<Vector3d>& world, const Estimate<Pose>& body) {
  if (!world.usable()) return world;
  Estimate<Vector3d> answer = world;
  const Eigen::Matrix3d back = body.value.rotation.conjugate().toRotationMatrix();
  answer.value = geometry::inverse(body.value) * world.value;
  Eigen::Matrix<double, 3, 6> by_body;
  by_body << back * estimation::skew(world.value - body.value.translation_m), -back;
  answer.covariance =
      back * world.covariance * back.transpose() + by_body * body.covariance * by_body.transpose();
  if (answer.verdict.standing == estimation::Standing::kWeak)
    answer.verdict.direction = back * world.verdict.direction;
  return answer;
}

/// Returns the translation's verdict from that of a weak pose.
estimation::Verdict part_of(const estimation::Verdict& pose) {
  const Vector3d step_m = pose.sigma * pose.direction.tail<3>();
  if (!(step_m.norm() > 0)) return estimation::Verdict::ok();
  return estimation::Verdict::weak(step_m.normalized(), step_m.norm(), pose.reason);
}

double rms_of_ranges(const ExternalInput& input, const std::vector<Sight>& sights,
                     const Vector3d& centre_m, const std::vector<int>& used) {
  double sum = 0;
  for (int i : used)
    sum += std::pow((input.markers[i].world_m - centre_m).norm() - sights[i].distance_m, 2);
  return used.empty() ? 0 : std::sqrt(sum / static_cast<double>(used.size()));
}

/// Reads a camera of a calibration.toml. Errors: those of reading it; kData if it lacks the camera.
Result<geometry::AnyCamera> named_camera(const std::filesystem::path& file,
                                         const std::string& name) {
  MIXRIG_ASSIGN(const calibration_file::Calibration calibration,
                calibration_file::read_calibration(file));
  if (const auto* camera = calibration.camera(name)) return camera->model;
  return Error{ErrorCode::kData,
               file.string() + ": holds no camera " + name + ": calibrate it first"};
}

}  // namespace

Result<ExternalInput> parse_external(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(config::Document document, config::Document::parse(text, name));
  const config::Table root = document.root();
  ExternalInput input;
  if (const config::Table camera = root.table("camera"); camera.present()) {
    input.camera_name = camera.text_or("name", input.camera_name);
    input.calibration_file = camera.text_or("calibration", "");
    if (input.calibration_file.empty()) input.camera = parse_camera(camera);
  }
  const config::Table noise = root.table("noise");
  if (noise.has("range_m")) input.sigma_range_m = noise.number("range_m", kNoise);
  input.sigma_px = noise.number_or("pixel_px", input.sigma_px, kNoise);
  input.body.sigma_m = noise.number_or("marker_m", input.body.sigma_m, kNoise);
  input.range_offset_m = root.number_or("range_offset_m", 0, {-10, 10});
  for (const config::Table& table : root.tables("marker"))
    input.markers.push_back(parse_marker(table));
  input.body.markers_m = points_of(root.tables("body_marker"), "position_m");
  input.body_seen_m = points_of(root.tables("body_seen"), "world_m");
  constexpr std::size_t kMost = 64;
  if (input.markers.size() < 3 || input.markers.size() > kMost)
    root.fail("marker", "3 to 64 [[marker]] tables are needed");
  if (input.body.markers_m.size() < 3 || input.body.markers_m.size() > kMost)
    root.fail("body_marker", "3 to 64 [[body_marker]] tables are needed");
  MIXRIG_TRY(document.finish());
  const auto verdict = estimation::check_constellation(input.body.markers_m, input.body.sigma_m);
  if (verdict.standing == estimation::Standing::kDegenerate)
    return Error{ErrorCode::kData,
                 name + ": the body's markers: " + verdict.reason + ": move a marker"};
  return input;
}

Result<ExternalInput> read_external(const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostBytes));
  MIXRIG_ASSIGN(ExternalInput input, parse_external(text, path.string()));
  if (input.calibration_file.empty()) return input;
  input.calibration_file = (path.parent_path() / input.calibration_file).string();
  MIXRIG_ASSIGN(input.camera, named_camera(input.calibration_file, input.camera_name));
  return input;
}

Result<ExternalCalibration> calibrate_external(const ExternalInput& input) {
  ExternalCalibration result;
  const auto match = estimation::match_constellation(input.body.markers_m, input.body_seen_m,
                                                     {input.body.sigma_m, 0});
  if (!match.usable())
    return Error{ErrorCode::kData, "the camera's body is not found among its observed markers: " +
                                       match.verdict.reason};
  result.world_from_body = {match.value.world_from_body, match.covariance, match.residuals,
                            match.inliers, match.verdict};
  std::vector<Sight> seen;
  std::vector<estimation::RangedSight> sights;
  for (const SeenMarker& marker : input.markers) {
    MIXRIG_ASSIGN(seen.emplace_back(), sight_of(marker, input));
    if (seen.back().bearing)
      sights.push_back({marker.world_m, *seen.back().bearing, seen.back().distance_m});
  }
  if (sights.size() < input.markers.size() || !input.sigma_range_m) {
    result.body_from_camera = Estimate<Pose>::degenerate(
        "distances alone say nothing about the orientation: give pixel_px of every marker, "
        "[camera] and noise.range_m");
    const auto centre = centre_of_ranges(input, seen, match.value.world_from_body);
    if (!centre.usable())
      return Error{ErrorCode::kData, "the distances do not determine the camera's position: " +
                                         centre.verdict.reason};
    result.range_rms_m = rms_of_ranges(input, seen, centre.value, centre.inliers);
    result.camera_in_body_m = in_body(centre, result.world_from_body);
    return result;
  }
  const auto camera = estimation::locate_camera(sights, *input.sigma_range_m);
  if (!camera.usable())
    return Error{ErrorCode::kData,
                 "the markers do not determine the camera's pose: " + camera.verdict.reason};
  result.range_rms_m = rms_of_ranges(input, seen, camera.value.translation_m, camera.inliers);
  result.body_from_camera = estimation::body_from_camera(result.world_from_body, camera);
  result.camera_in_body_m.value = result.body_from_camera.value.translation_m;
  result.camera_in_body_m.covariance = result.body_from_camera.covariance.bottomRightCorner<3, 3>();
  result.camera_in_body_m.residuals = camera.residuals;
  result.camera_in_body_m.inliers = camera.inliers;
  result.camera_in_body_m.verdict = camera.verdict.standing == estimation::Standing::kOk
                                        ? estimation::Verdict::ok()
                                        : part_of(result.body_from_camera.verdict);
  return result;
}

}  // namespace mixrig::mocap
