// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate external: where the camera sits on its tracked body.
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/pose/mocap/external.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

nlohmann::json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d sigmas(const Eigen::MatrixXd& covariance, int at) {
  return covariance.diagonal().segment<3>(at).cwiseSqrt();
}

nlohmann::json report_of(const mocap::ExternalCalibration& calibration) {
  const auto& place = calibration.camera_in_body_m;
  const auto& pose = calibration.body_from_camera;
  nlohmann::json report = {{"verdict", estimation::name_of(place.verdict.standing)},
                           {"camera_in_body_m", vector_json(place.value)},
                           {"camera_in_body_sigma_m", vector_json(sigmas(place.covariance, 0))},
                           {"range_rms_m", calibration.range_rms_m},
                           {"markers_used", place.inliers},
                           {"rotation_xyzw", nullptr},
                           {"rotation_sigma_deg", nullptr}};
  if (place.verdict.standing == estimation::Standing::kWeak) {
    report["weak_direction"] = vector_json(place.verdict.direction);
    report["weak_sigma_m"] = place.verdict.sigma;
  }
  if (!pose.usable()) return report;
  const auto& q = pose.value.rotation;
  report["rotation_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
  report["rotation_sigma_deg"] = vector_json(sigmas(pose.covariance, 0) / kDeg);
  return report;
}

void print(const mocap::ExternalCalibration& calibration) {
  const auto& place = calibration.camera_in_body_m;
  const auto& pose = calibration.body_from_camera;
  const Eigen::Vector3d mm = 1e3 * place.value, sigma_mm = 1e3 * sigmas(place.covariance, 0);
  std::printf("camera in body  %.1f %.1f %.1f mm  (sigma %.1f %.1f %.1f)\n", mm.x(), mm.y(), mm.z(),
              sigma_mm.x(), sigma_mm.y(), sigma_mm.z());
  if (pose.usable()) {
    const auto& q = pose.value.rotation;
    const Eigen::Vector3d deg = sigmas(pose.covariance, 0) / kDeg;
    std::printf("rotation        xyzw %.6f %.6f %.6f %.6f  (sigma %.3f %.3f %.3f deg)\n", q.x(),
                q.y(), q.z(), q.w(), deg.x(), deg.y(), deg.z());
  } else {
    std::printf("rotation        as tracked: %s\n", pose.verdict.reason.c_str());
  }
  std::printf("distances       %.1f mm RMS over %zu markers\n", 1e3 * calibration.range_rms_m,
              place.inliers.size());
  std::printf("verdict         %s", estimation::name_of(place.verdict.standing));
  if (place.verdict.standing == estimation::Standing::kWeak) {
    const auto& d = place.verdict.direction;
    std::printf(": along (%.2f, %.2f, %.2f) of the body, sigma %.1f mm", d[0], d[1], d[2],
                1e3 * place.verdict.sigma);
  }
  std::printf("\n");
}

struct ExternalArguments {
  std::string input, calibration;
};

/// Entry of calibration.toml with target_from_body. Errors: kData where the pose of the camera in
/// the target camera is not known.
Result<calibration_file::CalibratedPose> entry_of(const mocap::ExternalInput& input,
                                                  const mocap::ExternalCalibration& found,
                                                  const ExternalArguments& arguments) {
  const auto& pose = found.body_from_camera;
  if (!pose.usable())
    return Error{ErrorCode::kData,
                 arguments.input + ": nothing is written: " + pose.verdict.reason};
  geometry::Pose target_from_camera;
  if (input.camera_name != "target") {
    const std::string& file =
        input.calibration_file.empty() ? arguments.calibration : input.calibration_file;
    MIXRIG_ASSIGN(const calibration_file::Calibration known,
                  calibration_file::read_calibration(file));
    const auto* pose_of_camera = known.pose(input.camera_name);
    if (pose_of_camera == nullptr)
      return Error{ErrorCode::kData,
                   fmt::format("{}: has no pose of camera {} in the target camera: run mixrig "
                               "calibrate rig first",
                               file, input.camera_name)};
    target_from_camera = pose_of_camera->target_from;
  }
  calibration_file::CalibratedPose entry;
  entry.name = "body";
  entry.target_from = target_from_camera * geometry::inverse(pose.value);
  // Covariance of the inverse to first order, in the axes of the target camera.
  const Eigen::Matrix3d turn = entry.target_from.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> map = Eigen::Matrix<double, 6, 6>::Zero();
  map.topLeftCorner<3, 3>() = map.bottomRightCorner<3, 3>() = -turn;
  map.bottomLeftCorner<3, 3>() = -turn * estimation::skew(pose.value.translation_m);
  entry.covariance = map * pose.covariance * map.transpose();
  entry.views = 1;
  calibration_file::InputHash hash;
  MIXRIG_TRY(hash.add_file(arguments.input));
  entry.origin = calibration_file::origin_now(hash);
  return entry;
}

Result<nlohmann::json> calibrate(const ExternalArguments& arguments) {
  MIXRIG_ASSIGN(const mocap::ExternalInput input, mocap::read_external(arguments.input));
  const auto found = mocap::calibrate_external(input);
  if (!found) return Error{found.error().code, arguments.input + ": " + found.error().context};
  print(*found);
  if (!arguments.calibration.empty()) {
    calibration_file::Calibration calibration;
    MIXRIG_ASSIGN(calibration.poses.emplace_back(), entry_of(input, *found, arguments));
    MIXRIG_TRY(calibration_file::update_calibration(arguments.calibration, calibration));
  }
  return with_end(report_of(*found), arguments.calibration,
                  arguments.calibration.empty() ? "give --calibration FILE to keep the pose"
                                                : in_rig_toml(arguments.calibration));
}

}  // namespace

void add_calibrate_external_command(Command app, Context& context) {
  auto arguments = std::make_shared<ExternalArguments>();
  Command group = app.group("calibrate", "calibrate cameras and rig");
  Command command = group.add_subcommand(
      "external", "where the depth camera sits on its body, from a tracked constellation");
  command
      .add_option("FILE", arguments->input,
                  "TOML: markers, what the camera saw of them, and its body")
      .required();
  command.add_option("--calibration", arguments->calibration,
                     "calibration.toml to write the pose of the body into");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return calibrate(*arguments); }; });
}

}  // namespace mixrig::tools
