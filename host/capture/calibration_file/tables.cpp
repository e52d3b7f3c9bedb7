// SPDX-License-Identifier: Apache-2.0
#include "host/capture/calibration_file/tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace mixrig::calibration_file {
namespace {

using config::Range;
using config::Table;
using config::Writer;
using geometry::LensKind;

constexpr Range kSide{1, 16384}, kFocal{1, 1e6}, kCenter{-1e5, 1e5}, kLens{-1e9, 1e9};
constexpr Range kPlace_m{-1e6, 1e6}, kResidual_px{0, 1e6}, kCount{0, 1e9};
constexpr double kMostAway_m = 10;  // of two cameras of one rig
constexpr Range kVignetting{-3, 3}, kMaxAngle_rad{0.01, M_PI};

std::vector<double> row_by_row(const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      values.push_back(matrix(row, column));
  return values;
}

Eigen::VectorXd parse_parameters(const Table& table, LensKind kind) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(geometry::parameter_count(kind));
  values.head<4>() << table.number("fx", kFocal), table.number("fy", kFocal),
      table.number("cx", kCenter), table.number("cy", kCenter);
  if (kind == LensKind::kPinhole && !table.has("distortion")) return values;
  const auto most = static_cast<std::size_t>(values.size()) - 4;
  const auto lens = table.numbers("distortion", 4, most, kLens);
  std::copy(lens.begin(), lens.end(), values.data() + 4);
  return values;
}

/// Reads the largest angle of a fisheye, at the rim of its image circle.
std::optional<double> parse_max_angle(const Table& table, LensKind kind) {
  if (!table.has("max_angle_rad")) return std::nullopt;
  const double angle = table.number("max_angle_rad", kMaxAngle_rad);
  if (kind == LensKind::kFisheye) return angle;
  table.fail("max_angle_rad", "is for model = \"fisheye\" alone: remove it");
  return std::nullopt;
}

Eigen::Matrix3d parse_rotation(const Table& table) {
  const auto rows = table.matrix("rotation", 3, 3);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

/// Reads a quaternion as four numbers x, y, z, w.
Eigen::Quaterniond parse_quaternion(const Table& table) {
  const auto q = table.numbers("rotation_xyzw", 4, 4, {-2, 2});
  if (table.has("rotation"))
    table.fail("rotation", "given beside rotation_xyzw: remove one of them");
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (std::abs(rotation.norm() - 1) <= 1e-3) return rotation.normalized();
  table.fail("rotation_xyzw", "must have length 1: give a unit quaternion");
  return Eigen::Quaterniond::Identity();
}

Writer model_table(const geometry::AnyCamera& camera, bool name_the_model) {
  const Eigen::VectorXd values = geometry::parameters_of(camera);
  const LensKind kind = geometry::kind_of(camera);
  Writer table;
  if (name_the_model) table.set("model", geometry::name_of(kind));
  table.set("size_px", geometry::size_px(camera));
  table.set("fx", values[0]).set("fy", values[1]).set("cx", values[2]).set("cy", values[3]);
  const std::span<const double> lens(values.data() + 4,
                                     static_cast<std::size_t>(values.size()) - 4);
  const bool ideal = std::all_of(lens.begin(), lens.end(), [](double k) { return k == 0; });
  if (!ideal || kind != LensKind::kPinhole) table.set("distortion", lens);
  if (const auto angle = geometry::max_angle_rad(camera)) table.set("max_angle_rad", *angle);
  return table;
}

}  // namespace

Eigen::MatrixXd parse_square(const Table& table, const char* key, int rows) {
  if (!table.has(key)) return {};
  const auto count = static_cast<std::size_t>(rows);
  const auto values = table.matrix(key, count, count);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(values.data(), rows, rows);
}

Origin parse_origin(const Table& table) {
  return {table.text_or("date", ""), table.text_or("tool_version", ""),
          table.text_or("input_hash", "")};
}

void set_origin(Writer& table, const Origin& origin, const Eigen::MatrixXd& covariance) {
  if (!origin.date.empty()) table.set("date", origin.date);
  if (!origin.tool_version.empty()) table.set("tool_version", origin.tool_version);
  if (!origin.input_hash.empty()) table.set("input_hash", origin.input_hash);
  if (covariance.size() > 0)
    table.set_matrix("covariance", static_cast<std::size_t>(covariance.cols()),
                     row_by_row(covariance));
}

geometry::Vignetting parse_vignetting(const Table& table) {
  if (!table.has("vignetting")) return {};
  const auto v = table.numbers("vignetting", 2, 2, kVignetting);
  return {v[0], v[1]};
}

void set_vignetting(Writer& table, const geometry::Vignetting& vignetting) {
  if (!vignetting.is_none())
    table.set("vignetting", std::array<double, 2>{vignetting.a, vignetting.b});
}

CalibratedCamera parse_camera(const Table& table, const std::string& name) {
  CalibratedCamera camera;
  camera.name = name;
  const auto kind = static_cast<LensKind>(table.one_of("model", {"pinhole", "fisheye"}, 0));
  const auto size = table.numbers("size_px", 2, 2, kSide);
  camera.model = geometry::make_camera(kind, {static_cast<int>(size[0]), static_cast<int>(size[1])},
                                       parse_parameters(table, kind), parse_max_angle(table, kind));
  camera.vignetting = parse_vignetting(table);
  camera.lens = parse_lens_table(table, geometry::size_px(camera.model));
  if (camera.lens && kind != LensKind::kPinhole)
    table.fail("lens", "is for model = \"pinhole\" alone: remove it");
  camera.covariance = parse_square(table, "covariance", geometry::parameter_count(kind));
  camera.residual_px = table.number_or("residual_px", 0, kResidual_px);
  camera.views = table.integer_or("views", 0, kCount);
  camera.points = table.integer_or("points", 0, kCount);
  camera.origin = parse_origin(table);
  if (!table.present()) return camera;
  if (const auto valid = geometry::validate(camera.model); !valid) table.fail("fx", valid.error());
  return camera;
}

geometry::CameraModel parse_pinhole(const Table& table) {
  const CalibratedCamera camera = parse_camera(table, "");
  if (!camera.vignetting.is_none())
    table.fail("vignetting", "is read from a calibration file alone: move the camera there");
  if (camera.lens)
    table.fail("lens", "is read from a calibration file alone: move the camera there");
  if (const auto* pinhole = std::get_if<geometry::CameraModel>(&camera.model)) return *pinhole;
  table.fail("model", "must be \"pinhole\": colour and depth are not read through a fisheye");
  return {};
}

geometry::Pose parse_pose(const Table& table) {
  const auto t = table.numbers("translation_m", 3, 3, kPlace_m);
  const Eigen::Vector3d translation_m(t[0], t[1], t[2]);
  if (!table.present()) return {};
  if (table.has("rotation_xyzw")) return {parse_quaternion(table), translation_m};
  auto pose = geometry::pose_from_matrix(parse_rotation(table), translation_m);
  if (pose) return *pose;
  table.fail("rotation", pose.error());
  return {};
}

CalibratedPose parse_calibrated_pose(const Table& table, const std::string& name) {
  CalibratedPose pose;
  pose.name = name;
  pose.target_from = parse_pose(table);
  const double away_m = pose.target_from.translation_m.norm();
  if (away_m > kMostAway_m)
    table.fail("translation_m", fmt::format("puts the cameras {:.0f} m apart, which one rig cannot "
                                            "be: give it in metres, not in millimetres",
                                            away_m));
  pose.covariance = parse_square(table, "covariance", 6);
  pose.residual_px = table.number_or("residual_px", 0, kResidual_px);
  pose.views = table.integer_or("views", 0, kCount);
  pose.origin = parse_origin(table);
  return pose;
}

Writer camera_table(const geometry::AnyCamera& camera) {
  return model_table(camera, geometry::kind_of(camera) != LensKind::kPinhole);
}

Writer camera_table(const CalibratedCamera& camera) {
  Writer table = model_table(camera.model, true);
  set_vignetting(table, camera.vignetting);
  table.set("residual_px", camera.residual_px);
  table.set("views", camera.views).set("points", camera.points);
  set_origin(table, camera.origin, camera.covariance);
  if (camera.lens) add_lens_table(table, *camera.lens);
  return table;
}

Writer pose_table(const geometry::Pose& pose) {
  const Eigen::Vector4d xyzw = pose.rotation.coeffs();
  Writer table;
  table.set("rotation_xyzw", std::span<const double>(xyzw.data(), 4));
  table.set("translation_m", std::span<const double>(pose.translation_m.data(), 3));
  return table;
}

Writer pose_table(const CalibratedPose& pose) {
  Writer table = pose_table(pose.target_from);
  table.set("residual_px", pose.residual_px).set("views", pose.views);
  set_origin(table, pose.origin, pose.covariance);
  return table;
}

}  // namespace mixrig::calibration_file
