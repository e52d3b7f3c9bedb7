// SPDX-License-Identifier: Apache-2.0
// Kalibr's camchain YAML: cam0, cam1, ...; T_cn_cnm1 takes points of the previous camera.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "host/capture/calibration_file/exchange.h"
#include "host/capture/calibration_file/yaml_numbers.h"
#include "host/capture/calibration_file/yaml_table.h"

namespace mixrig::calibration_file {
namespace {

geometry::AnyCamera read_model(const YamlTable& table) {
  if (table.text("camera_model") != "pinhole")
    table.fail("camera_model", "must be pinhole: other camera models are not read");
  const std::string lens = table.text("distortion_model");
  if (lens != "radtan" && lens != "equidistant" && lens != "none")
    table.fail("distortion_model", "must be radtan, equidistant or none");
  const auto size = table.numbers("resolution", 2, 2);
  const bool sized = size[0] >= 1 && size[0] <= 16384 && size[1] >= 1 && size[1] <= 16384;
  if (!sized) table.fail("resolution", "must be a width and a height from 1 to 16384");
  const auto center = table.numbers("intrinsics", 4, 4);
  const auto k =
      lens == "none" ? std::vector<double>(4, 0.0) : table.numbers("distortion_coeffs", 4, 4);
  const auto kind =
      lens == "equidistant" ? geometry::LensKind::kFisheye : geometry::LensKind::kPinhole;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(geometry::parameter_count(kind));
  values.head<4>() << center[0], center[1], center[2], center[3];
  values.segment<4>(4) << k[0], k[1], k[2], k[3];
  const Size whole =
      sized ? Size{static_cast<int>(size[0]), static_cast<int>(size[1])} : Size{1, 1};
  const geometry::AnyCamera model = geometry::make_camera(kind, whole, values);
  if (const auto valid = geometry::validate(model); !valid)
    table.fail("intrinsics", valid.error().context);
  return model;
}

geometry::Pose read_step(const YamlTable& table) {
  const Eigen::MatrixXd m = table.square_or_empty("T_cn_cnm1", 4);
  if (m.size() == 0) return {};
  const auto pose = geometry::pose_from_matrix(m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>());
  if (pose) return *pose;
  table.fail("T_cn_cnm1", pose.error().context);
  return {};
}

/// Emits one camera. `before`: camera_from_reference of the previous camera, null for the first.
Result<void> emit(YAML::Emitter& out, const ForeignCamera& camera, const geometry::Pose* before) {
  const Eigen::VectorXd v = geometry::parameters_of(camera.model);
  const bool fisheye = geometry::kind_of(camera.model) == geometry::LensKind::kFisheye;
  if (!fisheye && v.tail<4>() != Eigen::Vector4d::Zero())
    return Error{ErrorCode::kUnsupported,
                 "camera " + camera.name +
                     ": Kalibr has no model with k3 to k6: calibrate it with --lens 4"};
  const Size size = geometry::size_px(camera.model);
  out << YAML::BeginMap << YAML::Key << "camera_model" << YAML::Value << "pinhole";
  out << YAML::Key << "intrinsics" << YAML::Value;
  emit_numbers(out, {v.data(), 4});
  out << YAML::Key << "distortion_model" << YAML::Value << (fisheye ? "equidistant" : "radtan");
  out << YAML::Key << "distortion_coeffs" << YAML::Value;
  emit_numbers(out, {v.data() + 4, 4});
  out << YAML::Key << "resolution" << YAML::Value << YAML::Flow << YAML::BeginSeq << size.width
      << size.height << YAML::EndSeq;
  if (before != nullptr) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> step =
        (camera.camera_from_reference * inverse(*before)).matrix();
    out << YAML::Key << "T_cn_cnm1" << YAML::Value << YAML::BeginSeq;
    for (int row = 0; row < 4; ++row) emit_numbers(out, {step.data() + 4 * row, 4});
    out << YAML::EndSeq;
  }
  out << YAML::EndMap;
  return {};
}

}  // namespace

Result<std::vector<ForeignCamera>> parse_kalibr(const std::string& text, const std::string& name) {
  MIXRIG_ASSIGN(const auto document, YamlDocument::parse(text, name));
  const YamlTable root = document.root();
  std::vector<ForeignCamera> cameras;
  geometry::Pose from_first;
  constexpr int kMaxCameras = 64;
  for (int i = 0; i < kMaxCameras; ++i) {
    const std::string key = fmt::format("cam{}", i);
    if (i > 0 && !root.has(key)) break;
    const YamlTable table = root.required_table(key);
    if (i > 0) from_first = read_step(table) * from_first;
    cameras.push_back({key, read_model(table), from_first});
  }
  MIXRIG_TRY(document.finish());
  return cameras;
}

Result<std::string> kalibr_text(const std::vector<ForeignCamera>& cameras) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  const geometry::Pose* before = nullptr;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    out << YAML::Key << fmt::format("cam{}", i) << YAML::Value;
    MIXRIG_TRY(emit(out, cameras[i], before));
    before = &cameras[i].camera_from_reference;
  }
  out << YAML::EndMap << YAML::Newline;
  return std::string(out.c_str());
}

}  // namespace mixrig::calibration_file
