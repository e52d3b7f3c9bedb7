// SPDX-License-Identifier: Apache-2.0
// Reads a camera file of any known kind.
#include "host/capture/calibration_file/exchange.h"

#include "host/capture/calibration_file/calibration.h"
#include "host/math/config/table.h"

namespace mixrig::calibration_file {
namespace {

constexpr std::size_t kMaxExchangeBytes = std::size_t{4}
                                          << 20;  ///< mrcal packs its inputs into the file

}  // namespace

FileKind sniff(const std::string& text) {
  const auto holds = [&](const char* word) { return text.find(word) != std::string::npos; };
  if (holds("LENSMODEL_")) return FileKind::kMrcal;
  if (holds("cam0:") && holds("intrinsics:")) return FileKind::kKalibr;
  if (holds("[cameras.") || text.starts_with("format =")) return FileKind::kMixrig;
  return FileKind::kOpencv;
}

Result<std::vector<ForeignCamera>> read_cameras(const std::filesystem::path& path) {
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxExchangeBytes));
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

}  // namespace mixrig::calibration_file
