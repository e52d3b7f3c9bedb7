// SPDX-License-Identifier: Apache-2.0
// mrcal's .cameramodel: a Python dictionary, which is read as a YAML flow mapping once the packed
// optimization_inputs are cut out. extrinsics are rt_fromref: a rotation vector and a translation
// that take points of the reference to the camera.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/capture/calibration_file/exchange.h"
#include "host/capture/calibration_file/yaml_table.h"

namespace mixrig::calibration_file {
namespace {

constexpr std::string_view kPrefix = "LENSMODEL_";

/// Removes b'...' of base85, which holds braces, from the dictionary.
std::string without_packed(const std::string& text) {
  const auto key = text.find("'optimization_inputs'");
  if (key == std::string::npos) return text;
  const auto begin = text.find("b'", key);
  const auto end = begin == std::string::npos ? begin : text.find('\'', begin + 2);
  return end == std::string::npos ? text : text.substr(0, begin) + "0" + text.substr(end + 1);
}

geometry::Pose pose_of(const std::vector<double>& rt) {
  const Eigen::Vector3d r(rt[0], rt[1], rt[2]);  // axis times angle
  const double angle = r.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(r / angle) : Eigen::Vector3d::UnitZ();
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), {rt[3], rt[4], rt[5]}};
}

/// Returns the number of distortion coefficients of a model: 0, 4, 5 or 8; nullopt for others.
std::optional<int> lens_terms(const std::string& model) {
  if (model == "LENSMODEL_PINHOLE") return 0;
  if (model == "LENSMODEL_OPENCV4") return 4;
  if (model == "LENSMODEL_OPENCV5") return 5;
  if (model == "LENSMODEL_OPENCV8") return 8;
  return std::nullopt;
}

}  // namespace

Result<ForeignCamera> parse_mrcal(const std::string& text, const std::string& name) {
  MIXRIG_ASSIGN(const auto document, YamlDocument::parse(without_packed(text), name));
  const YamlTable root = document.root();
  const std::string model = root.text(root.first_of({"lensmodel", "lens_model"}));
  const auto terms = lens_terms(model);
  if (!terms && model.starts_with(kPrefix))
    return Error{ErrorCode::kUnsupported,
                 name + ": " + model + " is not known: use LENSMODEL_OPENCV4, 5 or 8"};
  if (!terms) root.fail("lensmodel", "must be LENSMODEL_PINHOLE or LENSMODEL_OPENCV4, 5 or 8");
  const auto count = static_cast<std::size_t>(terms.value_or(0)) + 4;
  const auto intrinsics = root.numbers("intrinsics", count, count);
  const auto size = root.numbers("imagersize", 2, 2);
  const bool sized = size[0] >= 1 && size[0] <= 16384 && size[1] >= 1 && size[1] <= 16384;
  if (!sized) root.fail("imagersize", "must be a width and a height from 1 to 16384");
  const auto pose_key = root.first_of({"extrinsics", "rt_cam_ref"});
  const auto rt = root.has(pose_key) ? root.numbers(pose_key, 6, 6) : std::vector<double>(6, 0.0);
  MIXRIG_TRY(document.finish());
  Eigen::VectorXd values = Eigen::VectorXd::Zero(geometry::kPinholeParameters);
  std::copy(intrinsics.begin(), intrinsics.end(), values.data());
  ForeignCamera camera{
      "camera",
      geometry::make_camera(geometry::LensKind::kPinhole,
                            {static_cast<int>(size[0]), static_cast<int>(size[1])}, values),
      pose_of(rt)};
  if (const auto valid = geometry::validate(camera.model); !valid)
    return Error{ErrorCode::kFormat, name + ": " + valid.error().context};
  return camera;
}

Result<std::string> mrcal_text(const ForeignCamera& camera) {
  if (geometry::kind_of(camera.model) == geometry::LensKind::kFisheye)
    return Error{ErrorCode::kUnsupported,
                 "camera " + camera.name +
                     ": mrcal has no Kannala-Brandt fisheye: export it to Kalibr or OpenCV"};
  const Size size = geometry::size_px(camera.model);
  const Eigen::AngleAxisd turn(camera.camera_from_reference.rotation);
  const Eigen::Vector3d r = turn.angle() * turn.axis();
  const Eigen::Vector3d& t = camera.camera_from_reference.translation_m;
  const std::vector<double> rt{r.x(), r.y(), r.z(), t.x(), t.y(), t.z()};
  const Eigen::VectorXd values = geometry::parameters_of(camera.model);
  return fmt::format(
      "{{\n    'lensmodel':  'LENSMODEL_OPENCV8',\n    # fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6\n"
      "    'intrinsics': [{}],\n    # rt_fromref\n    'extrinsics': [{}],\n"
      "    'imagersize': [{}, {}]\n}}\n",
      fmt::join(values.data(), values.data() + values.size(), ", "), fmt::join(rt, ", "),
      size.width, size.height);
}

}  // namespace mixrig::calibration_file
