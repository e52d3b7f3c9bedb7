// SPDX-License-Identifier: Apache-2.0
// OpenCV's YAML (FileStorage) and ROS camera_info, which use the same matrices.
#include <array>
#include <span>

#include <yaml-cpp/yaml.h>

#include "host/capture/calibration_file/exchange.h"
#include "host/capture/calibration_file/yaml_numbers.h"
#include "host/capture/calibration_file/yaml_table.h"

namespace mixrig::calibration_file {
namespace {

Size read_size(const YamlTable& root) {
  std::vector<double> size{0, 0};
  if (const auto key = root.first_of({"img_size", "image_size", "imageSize"}); root.has(key)) {
    size = root.table(key).present() ? root.matrix_data(key, 2, 2) : root.numbers(key, 2, 2);
  } else {
    size = {root.number(root.first_of({"image_width", "width"}), 1, 16384),
            root.number(root.first_of({"image_height", "height"}), 1, 16384)};
  }
  if (size[0] >= 1 && size[0] <= 16384 && size[1] >= 1 && size[1] <= 16384)
    return {static_cast<int>(size[0]), static_cast<int>(size[1])};
  root.fail("image_width", "the picture size must lie in 1..16384");
  return {1, 1};
}

bool is_fisheye(const YamlTable& root) {
  const std::string model = root.text_or("distortion_model", "");
  return model == "equidistant" || model == "fisheye" ||
         root.number_or("fisheye_model", 0, 0, 1) != 0;
}

void emit_matrix(YAML::Emitter& out, const char* key, int rows, std::span<const double> data) {
  out << YAML::Key << key << YAML::Value << YAML::SecondaryTag("opencv-matrix") << YAML::BeginMap;
  out << YAML::Key << "rows" << YAML::Value << rows;
  out << YAML::Key << "cols" << YAML::Value << static_cast<int>(data.size()) / rows;
  out << YAML::Key << "dt" << YAML::Value << "d" << YAML::Key << "data" << YAML::Value;
  emit_numbers(out, data);
  out << YAML::EndMap;
}

}  // namespace

Result<ForeignCamera> parse_opencv(const std::string& text, const std::string& name) {
  MIXRIG_ASSIGN(const auto document, YamlDocument::parse(text, name));
  const YamlTable root = document.root();
  const Size size = read_size(root);
  const auto matrix_key =
      root.first_of({"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "M"});
  const auto k = root.matrix_data(matrix_key, 9, 9);
  if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    root.fail(matrix_key, "must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]: skew is not supported");
  const bool fisheye = is_fisheye(root);
  const auto lens_key = root.first_of(
      {"distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist", "D"});
  const auto lens = root.matrix_data(lens_key, 4, 14);
  const auto kind = fisheye ? geometry::LensKind::kFisheye : geometry::LensKind::kPinhole;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(geometry::parameter_count(kind));
  values.head<4>() << k[0], k[4], k[2], k[5];
  for (std::size_t i = 0; i < lens.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i) + 4;
    if (at < values.size())
      values[at] = lens[i];
    else if (lens[i] != 0)
      root.fail(lens_key,
                "thin prism and tilt coefficients are not supported: calibrate without them");
  }
  MIXRIG_TRY(document.finish());
  ForeignCamera camera{"camera", geometry::make_camera(kind, size, values), {}};
  if (const auto valid = geometry::validate(camera.model); !valid)
    return Error{ErrorCode::kFormat, name + ": " + valid.error().context};
  return camera;
}

Result<std::string> opencv_text(const ForeignCamera& camera) {
  const Size size = geometry::size_px(camera.model);
  const Eigen::VectorXd v = geometry::parameters_of(camera.model);
  const bool fisheye = geometry::kind_of(camera.model) == geometry::LensKind::kFisheye;
  const std::array<double, 9> matrix{v[0], 0, v[2], 0, v[1], v[3], 0, 0, 1};
  const std::span<const double> lens(v.data() + 4, static_cast<std::size_t>(v.size()) - 4);
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "image_width" << YAML::Value << size.width;
  out << YAML::Key << "image_height" << YAML::Value << size.height;
  if (fisheye) out << YAML::Key << "fisheye_model" << YAML::Value << 1;
  emit_matrix(out, "camera_matrix", 3, matrix);
  emit_matrix(out, "distortion_coefficients", static_cast<int>(lens.size()), lens);
  out << YAML::EndMap << YAML::Newline;
  // The directive with a colon is OpenCV's own; its reader requires it.
  return std::string("%YAML:1.0\n---\n") + out.c_str();
}

}  // namespace mixrig::calibration_file
