// SPDX-License-Identifier: Apache-2.0
// Joint calibration of all cameras of a rig, by corners and then by analysis of all pixels.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/calibrate/rig/depth_fit.h"
#include "host/calibrate/rig/rig_certainty.h"
#include "host/calibrate/rig/rig_start.h"
#include "host/capture/calibration_file/calibration.h"

namespace mixrig::calibration {

/// Name of a second depth camera in views.toml and calibration.toml.
inline constexpr const char* kSecondDepthCamera = "tof2";

/// Options of a rig's calibration. At most one depth camera takes part: its error is one of the
/// unknowns.
struct RigOptions {
  std::vector<std::string> cameras;  ///< names, the target camera first; empty: all
  bool pixels = true;                ///< false: corners alone
  bool bend = false;                 ///< solve for the board's bend even if it is not significant
  int threads = 0;                   ///< 0: one per core
};

/// Error on views that were left out of the fit: the board's pose is taken from the target camera's
/// corners alone, and the calibration predicts the corners in the other cameras.
struct HeldOut {
  std::string camera;
  double corners_px = 0, pixels_px = 0;  ///< root mean square after the corner and the pixel step
  int views = 0;
};

struct RigReport {
  RigModel by_corners, model;
  bool first_is_white = false;     ///< the board's top left square
  std::vector<Misfound> misfound;  ///< false detections of each camera
  std::vector<HeldOut> held_out;
  double load_s = 0, corners_s = 0, pixels_s = 0;
  /// Root mean square of each camera's corners over all views, after the corner step.
  std::vector<double> corner_px;
  /// Grey residual of each camera, as a share of the contrast from ink to paper.
  std::vector<double> grey_rms;
  std::optional<DepthFit> depth;
  std::vector<Intrinsics> alone;            ///< each camera by its corners alone: seen_alone()
  std::vector<Registration> registrations;  ///< of the cameras after the first
  std::vector<std::string> warnings;
  calibration_file::Calibration calibration;
};

/// Receives the name of the step and its progress. Called from any thread, one call at a time.
using RigProgress = std::function<void(const char* what, int done, int total)>;

/// Calibrates the cameras of a rig together. Errors: kUsage, kNotFound, kFormat of the set; kData
/// where it does not determine a calibration, with the reason and what to do.
Result<RigReport> calibrate_rig(const ViewSet& set, const RigOptions& options,
                                const RigProgress& progress);

/// Poses of the board in a camera with a known lens, from that camera's corners; unset in views
/// where it is not seen.
std::vector<std::optional<geometry::Pose>> refined_poses(const RigData& data, const RigModel& model,
                                                         std::size_t camera,
                                                         const std::vector<int>& views,
                                                         double sigma_px, Crew& crew);

}  // namespace mixrig::calibration
