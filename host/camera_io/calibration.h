// SPDX-License-Identifier: Apache-2.0
// calibration.yaml: the one file that every calibration writes, and that run, scan and track read.
// docs/formats.md shows it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"
#include "host/geometry/any_camera.h"
#include "host/geometry/pose.h"

namespace mixrig::camera_io {

/// Where an entry came from.
struct Origin {
  std::string date;          ///< of its making, ISO 8601 in UTC
  std::string tool_version;  ///< e.g. "mixrig 0.1.0"
  std::string input_hash;    ///< of the files it was computed from, InputHash
  bool operator==(const Origin&) const = default;
};

struct CalibratedCamera {
  std::string name;  ///< target, tof, fisheye, ...
  geometry::AnyCamera model;
  Eigen::MatrixXd covariance;  ///< of geometry::parameters_of(model); 0 x 0 where unknown. Rows of
                               ///< parameters that were held are zero.
  double residual_px = 0;      ///< root mean square distance of observed to projected points
  int views = 0, points = 0;   ///< that the residual is over
  Origin origin;
};

/// Where a camera (or the head) stands to the target camera.
struct CalibratedPose {
  std::string name;  ///< of the frame: tof, fisheye, head
  geometry::Pose target_from;
  Eigen::MatrixXd covariance;  ///< 6 x 6 in the parameters of estimation::pose_error (rotation,
                               ///< rad, then translation, m); 0 x 0 where unknown
  double residual_px = 0;
  int views = 0;
  Origin origin;
};

/// Systematic error of a ToF camera along the ray, measured minus true: a natural cubic spline over
/// the measured distance, straight beyond its ends, plus terms of amplitude and place.
struct DepthError {
  std::string camera = "tof";
  std::vector<double> knots_m;  ///< growing, two or more
  std::vector<double> error_m;  ///< at the knots
  double amplitude_m =
      0;  ///< error of amplitude_m / amplitude, amplitude in the unit of the camera
  /// Factors of u, v, u^2, u v, v^2, where u and v run from -1 to 1 over the picture, metres.
  std::array<double, 5> place_m{};
  Eigen::MatrixXd covariance;  ///< of error_m, amplitude_m, place_m; 0 x 0 where unknown
  double residual_m = 0;       ///< root mean square after correction
  Origin origin;

  /// Error at a measured distance; `amplitude` <= 0 leaves its term out; `px` in a picture of
  /// `size`.
  double at(double distance_m, double amplitude, const Eigen::Vector2d& px, Size size) const;
};

/// A pan-tilt unit: base_from_head = turn about the pan axis, then about the tilt axis, both given
/// with the unit at angles zero. An encoder angle a stands for scale * (a + offset).
struct PanTilt {
  struct Axis {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, in base axes
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();     ///< on the axis, in base axes
    double scale = 1, offset_rad = 0;
  };
  Axis pan, tilt;
  geometry::Pose head_from_target;  ///< the tool centre point is its translation
  double repeatability_rad = 0, repeatability_m = 0;
  Eigen::MatrixXd covariance;  ///< of the parameters that the calibration solved for, or 0 x 0
  double residual_px = 0;
  int views = 0;
  Origin origin;
};

struct Calibration {
  std::vector<CalibratedCamera> cameras;
  std::vector<CalibratedPose> poses;
  std::optional<DepthError> depth_error;
  std::optional<PanTilt> pan_tilt;

  /// The entry of that name; nullptr where there is none.
  const CalibratedCamera* camera(std::string_view name) const;
  const CalibratedPose* pose(std::string_view name) const;
};

/// Entries of `newer` take the place of those of the same name, the others stay.
void merge(Calibration& into, const Calibration& newer);

/// Errors: kNotFound, kFormat (file:line: key ...).
Result<Calibration> read_calibration(const std::filesystem::path& path);
/// The same from text; `name` stands for the file. Pure: what fuzzers feed.
Result<Calibration> parse_calibration(const std::string& text, const std::string& name);

std::string calibration_text(const Calibration& calibration);
/// Writes under a temporary name, then renames. Errors: kIo.
Result<void> write_calibration(const std::filesystem::path& path, const Calibration& calibration);
/// As write_calibration of what the file holds already, with `newer` merged into it.
Result<void> update_calibration(const std::filesystem::path& path, const Calibration& newer);

/// FNV-1a of the bytes of files, in the order in which they are added.
class InputHash {
 public:
  /// Errors: kNotFound where the file cannot be read.
  Result<void> add_file(const std::filesystem::path& path);
  void add_bytes(std::string_view bytes);
  std::string text() const;  ///< 16 hexadecimal digits

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};
/// Now, this tool and the hash.
Origin origin_now(const InputHash& hash);

}  // namespace mixrig::camera_io
