// SPDX-License-Identifier: Apache-2.0
#include "host/app/calibrated_source.h"

#include <optional>
#include <string>
#include <utility>

#include "hal/base/log.h"
#include "host/camera_io/calibration.h"
#include "host/camera_io/depth_correction.h"

namespace mixrig::app {
namespace {

class CalibratedSource final : public FrameSource {
 public:
  CalibratedSource(std::unique_ptr<FrameSource> source, take::TakeInfo info,
                   std::optional<camera_io::DepthCorrection> correction)
      : source_(std::move(source)), info_(std::move(info)), correction_(std::move(correction)) {}

  const take::TakeInfo& info() const override { return info_; }
  Result<bool> read(int number, take::TakeFrame& frame) override {
    MIXRIG_ASSIGN(const bool there, source_->read(number, frame));
    if (there && correction_) correct(frame);
    return there;
  }
  Result<void> read_truth(int number, take::TruthFrame& truth) override {
    return source_->read_truth(number, truth);
  }
  nlohmann::json report() const override { return source_->report(); }

 private:
  void correct(take::TakeFrame& frame);

  std::unique_ptr<FrameSource> source_;
  take::TakeInfo info_;
  std::optional<camera_io::DepthCorrection> correction_;
  bool warned_ = false;
};

void CalibratedSource::correct(take::TakeFrame& frame) {
  const Size size = info_.tof.size_px();
  if (frame.depth_m.size() != size) return;  // the compositor's to refuse
  const bool lit = frame.amplitude.size() == size;
  correction_->apply(frame.depth_m, lit ? frame.amplitude.view() : ImageView<float>());
  if (lit || warned_ || !correction_->wants_amplitude()) return;
  warned_ = true;
  log_warning("app",
              "the depth error has a term of the amplitude, these frames have none: it is "
              "left out");
}

std::string text(Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string names_of(const camera_io::Calibration& calibration) {
  std::string names;
  for (const auto& camera : calibration.cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return names.empty() ? "none" : names;
}

Result<geometry::CameraModel> camera_of(const camera_io::Calibration& calibration,
                                        const std::string& name, Size size) {
  const camera_io::CalibratedCamera* camera = calibration.camera(name);
  if (camera == nullptr)
    return Error{ErrorCode::kFormat, "cameras: \"" + name +
                                         "\" is missing, there are: " + names_of(calibration) +
                                         ": run mixrig calibrate rig, or name the camera so"};
  const auto* model = std::get_if<geometry::CameraModel>(&camera->model);
  if (model == nullptr)
    return Error{ErrorCode::kFormat, "cameras." + name +
                                         ": a fisheye, but colour and depth must be pinholes: "
                                         "calibrate it with --model pinhole"};
  if (model->size_px() != size)
    return Error{ErrorCode::kFormat, "cameras." + name + ": made of pictures of " +
                                         text(model->size_px()) + ", these are " + text(size) +
                                         ": calibrate at the size that is used"};
  return *model;
}

/// `info` with what the calibration says.
Result<take::TakeInfo> calibrated(take::TakeInfo info, const camera_io::Calibration& calibration) {
  MIXRIG_ASSIGN(info.target, camera_of(calibration, "target", info.target.size_px()));
  MIXRIG_ASSIGN(info.tof, camera_of(calibration, "tof", info.tof.size_px()));
  const camera_io::CalibratedPose* pose = calibration.pose("tof");
  if (pose == nullptr)
    return Error{ErrorCode::kFormat,
                 "target_from: \"tof\" is missing: run mixrig calibrate rig, which finds where the "
                 "depth camera stands"};
  info.target_from_tof = pose->target_from;
  if (calibration.depth_error && calibration.depth_error->camera != "tof")
    return Error{ErrorCode::kFormat, "depth_error: is of camera \"" +
                                         calibration.depth_error->camera +
                                         "\", not of \"tof\": remove it or calibrate again"};
  info.calibration.clear();
  return info;
}

}  // namespace

Result<std::unique_ptr<FrameSource>> with_calibration(std::unique_ptr<FrameSource> source,
                                                      const std::filesystem::path& calibration) {
  const std::filesystem::path file = calibration.empty() ? source->info().calibration : calibration;
  if (file.empty()) return source;
  MIXRIG_ASSIGN(const camera_io::Calibration known, camera_io::read_calibration(file));
  auto info = calibrated(source->info(), known);
  if (!info) return Error{info.error().code, file.string() + ": " + info.error().context};
  std::optional<camera_io::DepthCorrection> correction;
  if (known.depth_error)
    correction.emplace(*known.depth_error, info->tof,
                       info->depth_kind == take::DepthKind::kDistance);
  return std::unique_ptr<FrameSource>(std::make_unique<CalibratedSource>(
      std::move(source), *std::move(info), std::move(correction)));
}

}  // namespace mixrig::app
