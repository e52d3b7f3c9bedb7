// SPDX-License-Identifier: Apache-2.0
// Writing of take.toml.
#include <array>

#include "host/calibration_file/tables.h"
#include "host/config/writer.h"
#include "host/take/manifest.h"

namespace mixrig::take {
namespace {

using config::Writer;

Writer stream_table(const StreamInfo& stream) {
  Writer table;
  table.set("path", stream.path);
  table.set("first", stream.first).set("count", stream.count).set("rate_hz", stream.rate_hz);
  return table;
}

Writer depth_table(const TakeInfo& info) {
  Writer table = stream_table(info.depth);
  if (!info.raw_depth.empty()) table.set("raw", info.raw_depth);
  table.set("unit_m", info.depth_unit_m).set("unknown", info.depth_unknown);
  if (info.depth_offset_m != 0) table.set("offset_m", info.depth_offset_m);
  table.set("kind", info.depth_kind == capture::DepthKind::kZ ? "z" : "distance");
  table.set("noise", std::array<double, 3>{info.noise.floor_m, info.noise.linear,
                                           info.noise.quadratic_per_m});
  return table;
}

Writer amplitude_table(const TakeInfo& info) {
  Writer table = stream_table(*info.amplitude);
  if (info.amplitude_is_light) table.set("light", true);
  return table;
}

Writer target_table(const TakeInfo& info) {
  Writer table = calibration_file::camera_table(info.target);
  if (info.view)
    table.set("view", std::array<double, 4>{info.view->fx_px, info.view->fy_px, info.view->cx_px,
                                            info.view->cy_px});
  return table;
}

/// With a matrix, as takes have always had it: a quaternion would read back with other last bits.
Writer pose_table(const geometry::Pose& pose) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = pose.rotation.toRotationMatrix();
  Writer table;
  table.set_matrix("rotation", 3, {rotation.data(), 9});
  table.set("translation_m", std::span<const double>(pose.translation_m.data(), 3));
  return table;
}

Writer truth_table(const TakeInfo& info) {
  Writer table;
  table.set("path", "truth").set("depth_unit_m", info.truth_depth_unit_m);
  return table;
}

}  // namespace

std::string manifest_text(const TakeInfo& info) {
  Writer root, pose;
  root.set("format", 1).set("name", info.name).set("root", ".");
  if (!info.calibration.empty()) root.set("calibration", info.calibration.string());
  root.set("color", stream_table(info.color)).set("depth", depth_table(info));
  if (info.amplitude) root.set("amplitude", amplitude_table(info));
  if (info.fisheye && info.fisheye->count > 0) root.set("fisheye", stream_table(*info.fisheye));
  root.set("target", target_table(info));
  root.set("tof", calibration_file::camera_table(info.tof));
  root.set("target_from_tof", pose_table(info.target_from_tof));
  pose.set("file", "poses.txt");
  if (info.has_poses) root.set("pose", std::move(pose));
  if (info.has_truth) root.set("truth", truth_table(info));
  return root.text();
}

}  // namespace mixrig::take
