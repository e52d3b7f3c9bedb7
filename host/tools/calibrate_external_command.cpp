// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate external: where the camera sits on its tracked body.
#include <cmath>
#include <cstdio>
#include <memory>

#include "host/camera_io/calibration.h"
#include "host/mocap/external.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

constexpr double kDegrees = 57.29577951308232;

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
  report["rotation_sigma_deg"] = vector_json(kDegrees * sigmas(pose.covariance, 0));
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
    const Eigen::Vector3d deg = kDegrees * sigmas(pose.covariance, 0);
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

struct Words {
  std::string input, calibration;
};

/// target_from_body as an entry of calibration.yaml. Errors: kData where the way from the camera to
/// the target camera is not known.
Result<camera_io::CalibratedPose> entry_of(const mocap::ExternalInput& input,
                                           const mocap::ExternalCalibration& found,
                                           const Words& words) {
  const auto& pose = found.body_from_camera;
  if (!pose.usable())
    return Error{ErrorCode::kData, words.input + ": nothing is written: " + pose.verdict.reason};
  geometry::Pose target_from_camera;
  if (input.camera_name != "target") {
    const std::string& file =
        input.calibration_file.empty() ? words.calibration : input.calibration_file;
    MIXRIG_ASSIGN(const camera_io::Calibration known, camera_io::read_calibration(file));
    const auto* way = known.pose(input.camera_name);
    if (way == nullptr)
      return Error{ErrorCode::kData, file + ": does not tell where camera " + input.camera_name +
                                         " stands to the target camera: calibrate the rig first"};
    target_from_camera = way->target_from;
  }
  camera_io::CalibratedPose entry;
  entry.name = "body";
  entry.target_from = target_from_camera * geometry::inverse(pose.value);
  // First order of the inverse, in the target's axes.
  const Eigen::Matrix3d turn = entry.target_from.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> map = Eigen::Matrix<double, 6, 6>::Zero();
  map.topLeftCorner<3, 3>() = map.bottomRightCorner<3, 3>() = -turn;
  map.bottomLeftCorner<3, 3>() = -turn * estimation::skew(pose.value.translation_m);
  entry.covariance = map * pose.covariance * map.transpose();
  entry.views = 1;
  camera_io::InputHash hash;
  MIXRIG_TRY(hash.add_file(words.input));
  entry.origin = camera_io::origin_now(hash);
  return entry;
}

Result<nlohmann::json> calibrate(const Words& words) {
  MIXRIG_ASSIGN(const mocap::ExternalInput input, mocap::read_external(words.input));
  const auto found = mocap::calibrate_external(input);
  if (!found) return Error{found.error().code, words.input + ": " + found.error().context};
  print(*found);
  if (!words.calibration.empty()) {
    camera_io::Calibration calibration;
    MIXRIG_ASSIGN(calibration.poses.emplace_back(), entry_of(input, *found, words));
    MIXRIG_TRY(camera_io::update_calibration(words.calibration, calibration));
  }
  return report_of(*found);
}

}  // namespace

void add_calibrate_external_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App& group = command_group(app, "calibrate", "calibrate cameras and rig");
  CLI::App* command = group.add_subcommand(
      "external", "where the depth camera sits on its body, from a tracked constellation");
  command
      ->add_option("FILE", words->input, "TOML: markers, what the camera saw of them, and its body")
      ->required();
  command->add_option("--calibration", words->calibration,
                      "calibration.yaml that the pose of the body is written into");
  command->callback([&context, words] { context.action = [words] { return calibrate(*words); }; });
}

}  // namespace mixrig::tools
