// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/calibrated_source.h"

#include <optional>
#include <string>
#include <utility>

#include "hal/base/log.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/depth/depth_correction.h"

namespace mixrig::capture {
namespace {

class CalibratedSource final : public CaptureSource {
 public:
  CalibratedSource(std::unique_ptr<CaptureSource> source, SourceInfo info,
                   std::optional<depth::DepthCorrection> correction,
                   std::optional<depth::DepthCorrection> correction2)
      : source_(std::move(source)),
        info_(std::move(info)),
        cameras_(std::make_shared<RigCameras>(info_)),
        correction_(std::move(correction)),
        correction2_(std::move(correction2)) {}

  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    MIXRIG_ASSIGN(const bool there, source_->read(number, capture));
    if (!there) return false;
    capture.cameras = cameras_;
    if (correction_) correct(*correction_, info_.tof, capture.depth_m, capture.amplitude);
    if (correction2_)
      correct(*correction2_, info_.tof2->model, capture.depth2.depth_m, capture.depth2.amplitude);
    set_lens(capture);
    return true;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    return source_->read_truth(number, truth);
  }
  void share_plates(PlateForms forms) override { source_->share_plates(forms); }
  std::optional<SourceReport> report() const override { return source_->report(); }

 private:
  void correct(const depth::DepthCorrection& correction, const geometry::CameraModel& tof,
               Image<float>& depth_m, const Image<float>& amplitude);
  void set_lens(Capture& capture);

  std::unique_ptr<CaptureSource> source_;
  SourceInfo info_;
  std::shared_ptr<const RigCameras> cameras_;
  std::optional<depth::DepthCorrection> correction_, correction2_;
  FrameLens lens_;  ///< lens of the last capture
  bool has_lens_ = false, warned_ = false;
};

/// Sets the lens of a capture. A lens that moved by less than a picture can show stays the last
/// one, so that tables which depend on it are not rebuilt for the noise of the encoders.
void CalibratedSource::set_lens(Capture& capture) {
  constexpr double kLeastShift_px = 0.05, kFrom_m = 2;
  capture.lens.reset();
  if (!info_.lens) return;
  if (capture.encoders) {
    const geometry::LensState now = info_.lens->at(*capture.encoders);
    if (!has_lens_ || geometry::largest_shift_px(lens_.state, now, kFrom_m) > kLeastShift_px)
      lens_.state = now;
    lens_.origin =
        info_.lens->contains(*capture.encoders) ? LensOrigin::kEncoded : LensOrigin::kClamped;
    has_lens_ = true;
  } else if (has_lens_) {
    lens_.origin = LensOrigin::kHeld;
  }
  if (has_lens_) capture.lens = lens_;
}

void CalibratedSource::correct(const depth::DepthCorrection& correction,
                               const geometry::CameraModel& tof, Image<float>& depth_m,
                               const Image<float>& amplitude) {
  const Size size = tof.size_px();
  if (depth_m.size() != size) return;  // the compositor reports the error
  const bool lit = amplitude.size() == size;
  correction.apply(depth_m, lit ? amplitude.view() : ImageView<const float>());
  if (lit || warned_ || !correction.wants_amplitude()) return;
  warned_ = true;
  log_warning("capture",
              "the depth error has an amplitude term, but these frames have no amplitude: the term "
              "is left out");
}

std::string text(Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string names_of(const calibration_file::Calibration& calibration) {
  std::string names;
  for (const auto& camera : calibration.cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return names.empty() ? "none" : names;
}

Result<geometry::CameraModel> camera_of(const calibration_file::Calibration& calibration,
                                        const std::string& name, Size size) {
  const calibration_file::CalibratedCamera* camera = calibration.camera(name);
  if (camera == nullptr)
    return Error{ErrorCode::kFormat, "cameras: \"" + name +
                                         "\" is missing, there are: " + names_of(calibration) +
                                         ": run mixrig calibrate rig, or rename a camera"};
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

void warn_without_table(const SourceInfo& info) {
  if (info.has_lens_values)
    log_warning("capture", info.name +
                               ": the encoders of the lens are recorded, but the "
                               "calibration in use has no cameras.target.lens: the lens "
                               "is taken as fixed (mixrig calibrate lens makes the table)");
}

/// Uses the lens table for captures that have encoder values.
void use_lens(const calibration_file::CalibratedCamera& target, SourceInfo& info) {
  if (target.lens && info.has_lens_values)
    info.lens = std::make_shared<geometry::LensTable>(*target.lens);
  else if (target.lens)
    log_warning("capture", info.name +
                               ": the lens is calibrated by its encoders, but their values "
                               "are not recorded: cameras.target is used for every frame");
  else
    warn_without_table(info);
}

Result<geometry::Pose> pose_of(const calibration_file::Calibration& calibration,
                               const std::string& name) {
  if (const calibration_file::CalibratedPose* pose = calibration.pose(name))
    return pose->target_from;
  return Error{ErrorCode::kFormat, "target_from: \"" + name +
                                       "\" is missing: run mixrig calibrate rig, which finds the "
                                       "pose of the depth camera"};
}

Result<void> check_error(const std::optional<calibration_file::DepthError>& error, const char* key,
                         const std::string& camera) {
  if (!error || error->camera == camera) return {};
  return Error{ErrorCode::kFormat, std::string(key) + ": is of camera \"" + error->camera +
                                       "\", not of \"" + camera +
                                       "\": remove it or calibrate again"};
}

/// Returns `info` with the values of the calibration.
Result<SourceInfo> calibrated(SourceInfo info, const calibration_file::Calibration& calibration) {
  MIXRIG_ASSIGN(info.target, camera_of(calibration, "target", info.target.size_px()));
  info.vignetting = calibration.camera("target")->vignetting;
  use_lens(*calibration.camera("target"), info);
  MIXRIG_ASSIGN(info.tof, camera_of(calibration, "tof", info.tof.size_px()));
  MIXRIG_ASSIGN(info.target_from_tof, pose_of(calibration, "tof"));
  MIXRIG_TRY(check_error(calibration.depth_error, "depth_error", "tof"));
  if (info.tof2) {
    capture::SecondDepthCamera& tof2 = *info.tof2;
    MIXRIG_ASSIGN(tof2.model, camera_of(calibration, "tof2", tof2.model.size_px()));
    MIXRIG_ASSIGN(tof2.target_from_tof, pose_of(calibration, "tof2"));
    MIXRIG_TRY(check_error(calibration.depth_error2, "depth_error2", "tof2"));
  }
  info.calibration.clear();
  return info;
}

}  // namespace

Result<std::unique_ptr<CaptureSource>> with_calibration(std::unique_ptr<CaptureSource> source,
                                                        const std::filesystem::path& file) {
  if (file.empty()) {
    warn_without_table(source->info());
    return source;
  }
  MIXRIG_ASSIGN(const calibration_file::Calibration known,
                calibration_file::read_calibration(file));
  auto info = calibrated(source->info(), known);
  if (!info) return Error{info.error().code, file.string() + ": " + info.error().context};
  std::optional<depth::DepthCorrection> correction, correction2;
  if (known.depth_error)
    correction.emplace(*known.depth_error, info->tof, info->depth_kind == DepthKind::kDistance);
  if (info->tof2 && known.depth_error2)
    correction2.emplace(*known.depth_error2, info->tof2->model,
                        info->tof2->kind == DepthKind::kDistance);
  return std::unique_ptr<CaptureSource>(std::make_unique<CalibratedSource>(
      std::move(source), *std::move(info), std::move(correction), std::move(correction2)));
}

}  // namespace mixrig::capture
