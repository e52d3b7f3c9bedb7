// SPDX-License-Identifier: Apache-2.0
// External calibration (Cortes Reina 2015, section 3.1): the depth camera's pose on its tracked
// body.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "host/math/estimation/pose/external.h"
#include "host/math/geometry/any_camera.h"
#include "host/pose/mocap/constellation_file.h"

namespace mixrig::mocap {

/// A marker of the second constellation, which is in front of the camera.
struct SeenMarker {
  Eigen::Vector3d world_m = Eigen::Vector3d::Zero();  ///< position from the motion capture
  std::optional<Eigen::Vector2d> pixel_px;            ///< in the depth camera's picture
  bool is_depth = false;  ///< `measured_m` is z, which needs pixel_px; else the distance
  double measured_m = 0;
};

struct ExternalInput {
  std::optional<geometry::AnyCamera> camera;  ///< the depth camera; needed if markers have pixels
  std::string camera_name = "tof";
  std::string calibration_file;  ///< file that holds the camera; empty: the camera is in the input
  std::vector<SeenMarker> markers;
  double range_offset_m = 0;            ///< added to each distance, such as a marker's radius
  std::optional<double> sigma_range_m;  ///< absent: estimated from the residuals
  double sigma_px = 0.5;
  Constellation body;                        ///< markers of the camera's body
  std::vector<Eigen::Vector3d> body_seen_m;  ///< its markers from the motion capture, any order
};

/// Result of the calibration. If all markers have pixels and sigma_range_m is given, it holds the
/// whole pose. Otherwise it follows from distances alone, as in Cortes Reina 2015, and holds the
/// position: the orientation is taken from the tracking, and `body_from_camera` is degenerate.
struct ExternalCalibration {
  estimation::Estimate<geometry::Pose> world_from_body;
  estimation::Estimate<geometry::Pose> body_from_camera;
  estimation::Estimate<Eigen::Vector3d> camera_in_body_m;  ///< covariance 3x3
  /// Root mean square error of the distances that were used.
  double range_rms_m = 0;
};

/// Reads a TOML file, which docs/reference/calibration_file.md shows, and the camera that it names
/// in a calibration.toml beside it. Errors: kNotFound, kFormat (file:line: key); kData for a
/// constellation that looks the same when turned.
Result<ExternalInput> read_external(const std::filesystem::path& path);
/// Parses the text, without reading the other file. Pure: the entry point of the fuzzer.
Result<ExternalInput> parse_external(std::string_view text, const std::string& name);

/// Calibrates. Errors: kData, saying which of body and camera the data do not determine, and why.
Result<ExternalCalibration> calibrate_external(const ExternalInput& input);

}  // namespace mixrig::mocap
