// SPDX-License-Identifier: Apache-2.0
// Writing of take.toml.
#include <array>
#include <span>
#include <vector>

#include "host/capture/calibration_file/tables.h"
#include "host/capture/take/manifest.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/math/config/writer.h"

namespace mixrig::take {
namespace {

using config::Writer;

Writer stream_table(const StreamInfo& stream) {
  Writer table;
  table.set("path", stream.path);
  table.set("first", stream.first).set("count", stream.count).set("rate_hz", stream.rate_hz);
  if (stream.delay_s != 0) table.set("delay_ms", stream.delay_s * 1e3);
  return table;
}

Writer color_table(const TakeInfo& info) {
  Writer table = stream_table(info.color);
  if (info.exposure_s > 0) table.set("exposure_ms", info.exposure_s * 1e3);
  return table;
}

void set_steps(const Steps& steps, capture::DepthKind kind, const geometry::DepthNoise& noise,
               Writer& table) {
  table.set("unit_m", steps.unit);
  std::vector<double> unknown(steps.unknown.begin(), steps.unknown.end());
  std::erase(unknown, -1.0);
  if (unknown.size() > 1)
    table.set("unknown", std::span<const double>(unknown));
  else
    table.set("unknown", steps.unknown[0]);
  if (steps.offset != 0) table.set("offset_m", steps.offset);
  table.set("kind", kind == capture::DepthKind::kZ ? "z" : "distance");
  table.set("noise", std::array<double, 3>{noise.floor_m, noise.linear, noise.quadratic_per_m});
}

Writer depth_table(const TakeInfo& info, std::span<const int> further_unknown) {
  Writer table = stream_table(info.depth);
  if (!info.raw_depth.empty()) table.set("raw", info.raw_depth);
  set_steps(depth_steps(info, further_unknown), info.depth_kind, info.noise, table);
  return table;
}

Writer amplitude_table(const StreamInfo& stream, bool is_light) {
  Writer table = stream_table(stream);
  if (is_light) table.set("light", true);
  return table;
}

Writer target_table(const TakeInfo& info) {
  Writer table = calibration_file::camera_table(info.target);
  if (info.view)
    table.set("view", std::array<double, 4>{info.view->fx_px, info.view->fy_px, info.view->cx_px,
                                            info.view->cy_px});
  return table;
}

/// Writes the pose as a matrix: a quaternion would read back with different last bits.
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

/// Writes the streams of a second depth camera.
void add_second_depth(const TakeInfo& info, Writer& root) {
  const capture::SecondDepthCamera& camera = *info.tof2;
  Writer table = stream_table(info.depth2->depth);
  set_steps(depth_steps(camera), camera.kind, camera.noise, table);
  root.set("depth2", std::move(table));
  if (info.depth2->amplitude)
    root.set("amplitude2", amplitude_table(*info.depth2->amplitude, camera.amplitude_is_light));
}

}  // namespace

std::string manifest_text(const TakeInfo& info, bool unfinished,
                          std::span<const int> further_unknown) {
  Writer root, pose;
  root.set("format", 1).set("name", info.name).set("root", ".");
  if (unfinished) root.set("unfinished", true);
  if (!info.calibration.empty()) root.set("calibration", info.calibration.string());
  root.set("color", color_table(info)).set("depth", depth_table(info, further_unknown));
  if (info.amplitude)
    root.set("amplitude", amplitude_table(*info.amplitude, info.amplitude_is_light));
  if (info.depth2) add_second_depth(info, root);
  if (info.fisheye && info.fisheye->count > 0) root.set("fisheye", stream_table(*info.fisheye));
  root.set("target", target_table(info));
  root.set("tof", calibration_file::camera_table(info.tof));
  root.set("target_from_tof", pose_table(info.target_from_tof));
  if (info.depth2) {
    root.set("tof2", calibration_file::camera_table(info.tof2->model));
    root.set("target_from_tof2", pose_table(info.tof2->target_from_tof));
  }
  pose.set("file", "poses.txt");
  if (info.has_poses) root.set("pose", std::move(pose));
  if (info.has_truth) root.set("truth", truth_table(info));
  return root.text();
}

}  // namespace mixrig::take
