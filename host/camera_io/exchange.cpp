// SPDX-License-Identifier: Apache-2.0
// What the files of other tools share: telling them apart, and reading whichever it is.
#include "host/camera_io/exchange.h"

#include <cerrno>
#include <fstream>

#include "host/camera_io/calibration.h"

namespace mixrig::camera_io {

FileKind sniff(const std::string& text) {
  const auto holds = [&](const char* word) { return text.find(word) != std::string::npos; };
  if (holds("LENSMODEL_")) return FileKind::kMrcal;
  if (holds("cam0:") && holds("intrinsics:")) return FileKind::kKalibr;
  if (holds("format:") && !holds("camera_matrix")) return FileKind::kMixrig;
  return FileKind::kOpencv;
}

Result<std::vector<ForeignCamera>> read_cameras(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    return system_error(ErrorCode::kNotFound, "cannot read camera file '" + path.string() + "'",
                        errno);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::string name = path.string();
  const FileKind kind = sniff(text);
  if (kind == FileKind::kKalibr) return parse_kalibr(text, name);
  if (kind == FileKind::kMixrig) {
    MIXRIG_ASSIGN(const Calibration calibration, parse_calibration(text, name));
    std::vector<ForeignCamera> cameras;
    for (const CalibratedCamera& camera : calibration.cameras) {
      const CalibratedPose* pose = calibration.pose(camera.name);
      cameras.push_back(
          {camera.name, camera.model, pose ? inverse(pose->target_from) : geometry::Pose{}});
    }
    return cameras;
  }
  MIXRIG_ASSIGN(ForeignCamera camera,
                kind == FileKind::kMrcal ? parse_mrcal(text, name) : parse_opencv(text, name));
  camera.name = path.stem().string();
  return std::vector{camera};
}

}  // namespace mixrig::camera_io
