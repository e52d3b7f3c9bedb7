// SPDX-License-Identifier: Apache-2.0
// Cameras and poses as TOML tables. calibration.toml holds them by name; take.toml and rig.toml may
// hold the same tables inline ([target], [tof], [target_from_tof]).
// docs/reference/calibration_file.md shows them.
#pragma once

#include <optional>
#include <string>

#include "host/capture/calibration_file/calibration.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"
#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"

namespace mixrig::calibration_file {

/// Reads model, size_px, fx, fy, cx, cy, distortion and the optional max_angle_rad (fisheye),
/// vignetting, lens, covariance, residual_px, views, points, date, tool_version and input_hash.
/// Errors are noted in the document.
CalibratedCamera parse_camera(const config::Table& table, const std::string& name);
/// Reads the optional vignetting, [a, b] of geometry::Vignetting; writes it unless it is none.
geometry::Vignetting parse_vignetting(const config::Table& table);
void set_vignetting(config::Writer& table, const geometry::Vignetting& vignetting);
/// Reads or writes the nodes of the optional [[lens]].
std::optional<geometry::LensTable> parse_lens_table(const config::Table& table, Size size_px);
void add_lens_table(config::Writer& table, const geometry::LensTable& lens);
/// parse_camera for a table that must hold a pinhole; an absent table gives defaults.
geometry::CameraModel parse_pinhole(const config::Table& table);
/// Reads translation_m and either rotation (three rows) or rotation_xyzw. Identity if the table is
/// absent or wrong; errors are noted in the document.
geometry::Pose parse_pose(const config::Table& table);
/// Reads what parse_pose() reads, and the optional covariance, residual_px, views, date,
/// tool_version and input_hash. Cameras more than 10 m apart are an error.
CalibratedPose parse_calibrated_pose(const config::Table& table, const std::string& name);

/// Returns the table that parse_camera() reads back as the same model. Keys that equal their
/// default are left out: model = "pinhole", a distortion of zeros.
config::Writer camera_table(const geometry::AnyCamera& camera);
config::Writer camera_table(const CalibratedCamera& camera);
/// Returns a table of a pose, with rotation_xyzw.
config::Writer pose_table(const geometry::Pose& pose);
config::Writer pose_table(const CalibratedPose& pose);

/// Reads a square matrix of `rows` rows; 0 x 0 where the key is absent.
Eigen::MatrixXd parse_square(const config::Table& table, const char* key, int rows);
/// Reads date, tool_version and input_hash of an entry.
Origin parse_origin(const config::Table& table);
/// Writes the keys that parse_origin() reads, unless they are empty, and `covariance` unless it is
/// 0 x 0.
void set_origin(config::Writer& table, const Origin& origin, const Eigen::MatrixXd& covariance);

}  // namespace mixrig::calibration_file
