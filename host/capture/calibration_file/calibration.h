// SPDX-License-Identifier: Apache-2.0
// calibration.toml: every calibration writes it, and run, scan and track read it.
// docs/reference/calibration_file.md shows it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/lens_table.h"
#include "host/math/geometry/pose.h"
#include "host/math/geometry/vignetting.h"

namespace mixrig::calibration_file {

/// Origin of an entry: date, program and input.
struct Origin {
  std::string date;          ///< when it was made, ISO 8601 in UTC
  std::string tool_version;  ///< e.g. "mixrig 0.1.0"
  std::string input_hash;    ///< InputHash of the files that it was computed from
  bool operator==(const Origin&) const = default;
};

struct CalibratedCamera {
  std::string name;  ///< target, tof, fisheye, ...
  geometry::AnyCamera model;
  Eigen::MatrixXd covariance;  ///< of geometry::parameters_of(model); 0 x 0 where unknown. Rows of
                               ///< parameters that were held constant are zero.
  double residual_px = 0;      ///< root mean square distance of observed to projected points
  int views = 0, points = 0;   ///< number of views and points in residual_px
  Origin origin;
  geometry::Vignetting vignetting{};  ///< pinholes only; none if it was not measured
  /// Lens by its encoders, for a pinhole whose lens zooms or focuses. `model` is the setting at
  /// which the poses of the rig were calibrated.
  std::optional<geometry::LensTable> lens{};
};

/// Pose of a camera (or of the head, or of a tracked body) in the target camera.
struct CalibratedPose {
  std::string name;  ///< name of the frame: tof, fisheye, head
  geometry::Pose target_from;
  Eigen::MatrixXd covariance;  ///< 6 x 6 in the parameters of estimation::pose_error (rotation,
                               ///< rad, then translation, m); 0 x 0 where unknown
  double residual_px = 0;
  int views = 0;
  Origin origin;
};

/// Systematic error of a ToF camera along the ray, measured minus true: a natural cubic spline over
/// the measured distance, constant beyond its ends, plus terms of amplitude and of the place in the
/// picture.
struct DepthError {
  std::string camera = "tof";
  std::vector<double> knots_m;  ///< growing, two or more
  std::vector<double> error_m;  ///< at the knots
  double amplitude_m = 0;       ///< adds amplitude_m / amplitude, amplitude in the camera's unit
  /// Coefficients of u, v, u^2, u v, v^2, metres; u and v run from -1 to 1 over the picture.
  std::array<double, 5> place_m{};
  Eigen::MatrixXd covariance;  ///< of error_m, amplitude_m, place_m; 0 x 0 where unknown
  double residual_m = 0;       ///< root mean square after correction
  Origin origin;

  /// Returns the error at a measured distance. `amplitude` <= 0 leaves its term out; `px` lies in a
  /// picture of `size`.
  double at(double distance_m, double amplitude, const Eigen::Vector2d& px, Size size) const;
};

/// A pan-tilt unit: base_from_head = rotation about the pan axis * rotation about the tilt axis,
/// both axes as they are at angles zero. The angle of an encoder value a is scale * (a + offset).
struct PanTilt {
  struct Axis {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, in base axes
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();     ///< on the axis, in base axes
    double scale = 1, offset_rad = 0;
    double step_rad = 0;  ///< the encoder rounds to steps of this; 0: unknown
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
  std::optional<DepthError> depth_error2;  ///< error of a second depth camera, `tof2`
  std::optional<PanTilt> pan_tilt;

  /// Returns the entry of that name; nullptr if there is none.
  const CalibratedCamera* camera(std::string_view name) const;
  const CalibratedPose* pose(std::string_view name) const;
};

/// Replaces entries by those of `newer` with the same name; the others stay. A camera without
/// vignetting keeps the old one; a pinhole without lens table keeps the old table if the picture
/// size is the same.
void merge(Calibration& into, const Calibration& newer);

/// Reads a calibration file; cameras and poses are in alphabetical order. Errors: kNotFound,
/// kFormat (file:line: key ...).
Result<Calibration> read_calibration(const std::filesystem::path& path);
/// Parses a calibration; `name` stands for the file. Pure: fuzzers call it.
Result<Calibration> parse_calibration(std::string_view text, const std::string& name);

/// Returns the calibration as TOML, from which parse_calibration() reads back the same bits.
std::string calibration_text(const Calibration& calibration);
/// Writes a whole file or leaves what was there. Errors: kIo.
Result<void> write_calibration(const std::filesystem::path& path, const Calibration& calibration);
/// Merges `newer` into the file, or creates it. Errors: those of read_calibration() and
/// write_calibration().
Result<void> update_calibration(const std::filesystem::path& path, const Calibration& newer);

/// FNV-1a hash of the bytes of files, in the order in which they are added.
class InputHash {
 public:
  /// Errors: kNotFound where the file cannot be read.
  Result<void> add_file(const std::filesystem::path& path);
  void add_bytes(std::string_view bytes);
  std::string text() const;  ///< 16 hexadecimal digits

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};
/// Returns an Origin with the present time, this tool and the hash.
Origin origin_now(const InputHash& hash);

}  // namespace mixrig::calibration_file
