// SPDX-License-Identifier: Apache-2.0
// Kalibr's camchain YAML: cam0, cam1, ...; T_cn_cnm1 takes points of the camera before.
#include "host/camera_io/exchange.h"
#include "host/camera_io/yaml_table.h"
#include "host/camera_io/yaml_text.h"

namespace mixrig::camera_io {
namespace {

geometry::AnyCamera read_model(const YamlTable& table) {
  if (table.text("camera_model") != "pinhole")
    table.fail("camera_model", "only pinhole is known (with radtan, equidistant or none)");
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

Result<std::string> camera_lines(const ForeignCamera& camera, const geometry::Pose* before) {
  const Eigen::VectorXd v = geometry::parameters_of(camera.model);
  const bool fisheye = geometry::kind_of(camera.model) == geometry::LensKind::kFisheye;
  if (!fisheye && v.tail<4>() != Eigen::Vector4d::Zero())
    return Error{ErrorCode::kUnsupported,
                 "camera " + camera.name +
                     ": Kalibr knows no lens with k3 to k6: calibrate it with --lens 4"};
  const Size size = geometry::size_px(camera.model);
  std::string text = "  camera_model: pinhole\n  intrinsics: " + list(v.data(), 4) +
                     "\n  distortion_model: " + (fisheye ? "equidistant" : "radtan") +
                     "\n  distortion_coeffs: " + list(v.data() + 4, 4) + "\n  resolution: [" +
                     std::to_string(size.width) + ", " + std::to_string(size.height) + "]\n";
  if (before != nullptr)
    text +=
        "  T_cn_cnm1:\n" + rows((camera.camera_from_reference * inverse(*before)).matrix(), "  ");
  return text;
}

}  // namespace

Result<std::vector<ForeignCamera>> parse_kalibr(const std::string& text, const std::string& name) {
  MIXRIG_ASSIGN(const auto document, YamlDocument::parse(text, name));
  const YamlTable root = document.root();
  std::vector<ForeignCamera> cameras;
  geometry::Pose from_first;
  constexpr int kMaxCameras = 64;
  for (int i = 0; i < kMaxCameras; ++i) {
    const std::string key = "cam" + std::to_string(i);
    if (i > 0 && !root.has(key)) break;
    const YamlTable table = root.required_table(key);
    if (i > 0) from_first = read_step(table) * from_first;
    cameras.push_back({key, read_model(table), from_first});
  }
  MIXRIG_TRY(document.finish());
  return cameras;
}

Result<std::string> kalibr_text(const std::vector<ForeignCamera>& cameras) {
  std::string text;
  const geometry::Pose* before = nullptr;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    MIXRIG_ASSIGN(const std::string lines, camera_lines(cameras[i], before));
    text += "cam" + std::to_string(i) + ":\n" + lines;
    before = &cameras[i].camera_from_reference;
  }
  return text;
}

}  // namespace mixrig::camera_io
