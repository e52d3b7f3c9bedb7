// SPDX-License-Identifier: Apache-2.0
// Writing of take.toml.
#include <array>

#include "host/config/toml_text.h"
#include "host/take/manifest.h"

namespace mixrig::take {
namespace {

using config::toml_array;
using config::toml_number;
using config::toml_text;

std::string stream_text(const char* table, const StreamInfo& stream) {
  return std::string("\n[") + table + "]\npath = " + toml_text(stream.path) +
         "\nfirst = " + std::to_string(stream.first) + "\ncount = " + std::to_string(stream.count) +
         "\nrate_hz = " + toml_number(stream.rate_hz) + "\n";
}

std::string camera_text(const char* table, const geometry::CameraModel& camera) {
  const geometry::Pinhole& p = camera.pinhole;
  std::string text = std::string("\n[") + table + "]\nsize_px = [" +
                     std::to_string(p.size_px.width) + ", " + std::to_string(p.size_px.height) +
                     "]\nfx = " + toml_number(p.fx_px) + "\nfy = " + toml_number(p.fy_px) +
                     "\ncx = " + toml_number(p.cx_px) + "\ncy = " + toml_number(p.cy_px) + "\n";
  if (!camera.lens.is_ideal())
    text += "distortion = " + toml_array(camera.lens.coefficients()) + "\n";
  return text;
}

std::string pose_text(const geometry::Pose& pose) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  std::string text = "rotation = [";
  for (int row = 0; row < 3; ++row) {
    const std::array<double, 3> values{r(row, 0), r(row, 1), r(row, 2)};
    text += (row > 0 ? ", " : "") + toml_array(values);
  }
  const Eigen::Vector3d& t = pose.translation_m;
  return text + "]\ntranslation_m = " + toml_array(std::array<double, 3>{t.x(), t.y(), t.z()}) +
         "\n";
}

std::string depth_text(const TakeInfo& info) {
  const std::array<double, 3> noise{info.noise.floor_m, info.noise.linear,
                                    info.noise.quadratic_per_m};
  return stream_text("depth", info.depth) + "unit_m = " + toml_number(info.depth_unit_m) +
         "\nunknown = " + std::to_string(info.depth_unknown) +
         "\nkind = " + (info.depth_kind == DepthKind::kZ ? "\"z\"" : "\"distance\"") +
         "\nnoise = " + toml_array(noise) + "\n";
}

}  // namespace

std::string manifest_text(const TakeInfo& info) {
  std::string text = "format = 1\nname = " + toml_text(info.name) + "\nroot = \".\"\n";
  if (!info.calibration.empty())
    text += "calibration = " + toml_text(info.calibration.string()) + "\n";
  text += stream_text("color", info.color) + depth_text(info);
  if (info.amplitude) text += stream_text("amplitude", *info.amplitude);
  text += camera_text("target", info.target);
  if (info.view) {
    const std::array<double, 4> view{info.view->fx_px, info.view->fy_px, info.view->cx_px,
                                     info.view->cy_px};
    text += "view = " + toml_array(view) + "\n";
  }
  text += camera_text("tof", info.tof);
  text += "\n[target_from_tof]\n" + pose_text(info.target_from_tof);
  if (info.has_poses) text += "\n[pose]\nfile = \"poses.txt\"\n";
  if (info.has_truth)
    text += "\n[truth]\npath = \"truth\"\ndepth_unit_m = " + toml_number(info.truth_depth_unit_m) +
            "\n";
  return text;
}

}  // namespace mixrig::take
