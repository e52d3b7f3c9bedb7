// SPDX-License-Identifier: Apache-2.0
// OpenCV's YAML (FileStorage) and ROS camera_info, which use the same matrices.
#include <cmath>

#include "host/camera_io/exchange.h"
#include "host/camera_io/yaml_table.h"
#include "host/camera_io/yaml_text.h"

namespace mixrig::camera_io {
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

std::string matrix_lines(const char* key, int rows, int columns, const std::vector<double>& data) {
  return std::string(key) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(columns) +
         "\n   dt: d\n   data: " + list(data.data(), data.size()) + "\n";
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
    root.fail(matrix_key, "must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]: a skewed camera is not known");
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
      root.fail(lens_key, "thin prism and tilt coefficients are not known");
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
  const std::vector<double> lens(v.data() + 4, v.data() + v.size());
  return "%YAML:1.0\n---\nimage_width: " + std::to_string(size.width) +
         "\nimage_height: " + std::to_string(size.height) + "\n" +
         (fisheye ? "fisheye_model: 1\n" : "") +
         matrix_lines("camera_matrix", 3, 3, {v[0], 0, v[2], 0, v[1], v[3], 0, 0, 1}) +
         matrix_lines("distortion_coefficients", static_cast<int>(lens.size()), 1, lens);
}

}  // namespace mixrig::camera_io
