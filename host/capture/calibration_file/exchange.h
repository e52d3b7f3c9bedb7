// SPDX-License-Identifier: Apache-2.0
// Cameras in the files of other tools: OpenCV YAML, Kalibr camchain YAML, mrcal .cameramodel. Like
// mixrig, all of them put pixel (0, 0) at the centre of the top-left pixel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"

namespace mixrig::calibration_file {

/// A camera as the file of another tool describes it.
struct ForeignCamera {
  std::string name;
  geometry::AnyCamera model;
  /// Reference: the first camera (Kalibr) or the file's own (mrcal).
  geometry::Pose camera_from_reference;
};

enum class FileKind { kMixrig, kOpencv, kKalibr, kMrcal };

/// Guesses the kind of a file from its content.
FileKind sniff(const std::string& text);

/// Parses one camera: camera_matrix (also K, M, cameraMatrix) and distortion_coefficients (also
/// dist, D), image_width and image_height (also img_size); ROS camera_info files too. It is a
/// fisheye with fisheye_model: 1 or distortion_model: equidistant. Errors: kFormat (file:line: key
/// ...).
Result<ForeignCamera> parse_opencv(const std::string& text, const std::string& name);
Result<std::string> opencv_text(const ForeignCamera& camera);

/// Parses cam0, cam1, ... with pinhole projection and radtan, equidistant or no distortion.
Result<std::vector<ForeignCamera>> parse_kalibr(const std::string& text, const std::string& name);
/// Writes a Kalibr camchain. Errors: kUnsupported for a lens with k3 to k6, for which Kalibr has no
/// model.
Result<std::string> kalibr_text(const std::vector<ForeignCamera>& cameras);

/// Parses LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, 5 and 8. Errors: kFormat; kUnsupported for other
/// models.
Result<ForeignCamera> parse_mrcal(const std::string& text, const std::string& name);
/// Writes an mrcal model. Errors: kUnsupported for a fisheye: mrcal 2 has no Kannala-Brandt model.
Result<std::string> mrcal_text(const ForeignCamera& camera);

/// Reads any of these files, or a calibration.toml. Errors: kNotFound, kFormat, kUnsupported.
Result<std::vector<ForeignCamera>> read_cameras(const std::filesystem::path& path);

}  // namespace mixrig::calibration_file
