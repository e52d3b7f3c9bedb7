// SPDX-License-Identifier: Apache-2.0
// The axes of a pan-tilt unit and the camera on it.
#include "host/calibrate/pan_tilt/calibrate_ptu.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Core>

#include "hal/base/order_statistics.h"
#include "host/math/geometry/linear.h"

namespace mixrig::calibration {
namespace {

constexpr double kMostRepeatability_rad = 0.02;
constexpr int kChainParameters = 16;
constexpr double kMostTurns =
    15;  ///< of pictures for each turn of the unit; 57 where it is radians

SeenCorners only(const SeenCorners& corners, std::size_t camera) {
  SeenCorners out;
  for (const auto& view : corners) out.push_back({view[camera]});
  return out;
}

/// Views with the board's pose and its covariance.
struct Poses {
  std::vector<int> views;
  std::vector<estimation::PanTiltView> chain;
};

Poses measure(const RigData& data, RigModel& model, double& sigma_px, Crew& crew) {
  Poses poses;
  const std::vector<int> seen = seen_by(data, 0);
  auto refined = refined_poses(data, model, 0, seen, 0.1, crew);
  for (const int view : seen)
    if (refined[view]) model.target_from_board[view] = *refined[view];
  sigma_px = std::max(corner_error(data, model, 0, seen).rms_px / std::sqrt(2.0), 0.005);
  RigModel fixed = model;
  fixed.cameras[0].free.clear();
  const SeenCorners corners = only(data.corners, 0);
  const RigLayout layout = layout_of(fixed, {});
  const ViewFunction term = corner_terms(data.print, corners, {sigma_px});
  for (const int view : seen) {
    if (!refined[view]) continue;
    const ViewTerm sums = term(fixed, layout, view);
    const Eigen::Matrix<double, 6, 6> information = sums.sum.topLeftCorner<6, 6>();
    const ViewSet::Angles& angles = data.set.angles[view];
    poses.views.push_back(view);
    poses.chain.push_back(
        {angles.pan_rad, angles.tilt_rad, *refined[view], geometry::inverse_of(information)});
  }
  return poses;
}

/// How far the pictures turn for each unit of angle that the encoders say: the median over views of
/// the turn against the first one; 0 where they do not turn.
double picture_turns_per_angle(const Poses& poses) {
  constexpr double kLeastTurn_rad = 0.02;
  std::vector<double> ratios;
  for (const estimation::PanTiltView& view : poses.chain) {
    const estimation::PanTiltView& first = poses.chain.front();
    const double turned =
        view.camera_from_target.rotation.angularDistance(first.camera_from_target.rotation);
    const double said = std::hypot(view.pan_rad - first.pan_rad, view.tilt_rad - first.tilt_rad);
    if (turned > kLeastTurn_rad && said > 0) ratios.push_back(turned / said);
  }
  return upper_median(std::move(ratios));
}

double chi2(const estimation::Estimate<estimation::PanTiltCalibration>& found) {
  return found.residuals.squaredNorm();
}

/// The repeatability for which the residuals match their expected size.
double find_repeatability(const Poses& poses) {
  const auto dof = static_cast<double>(6 * poses.chain.size() - kChainParameters);
  const auto excess = [&](double sigma) {
    const auto found = estimation::calibrate_pan_tilt(poses.chain, sigma);
    return found.usable() ? chi2(found) - dof : 1e300;
  };
  if (excess(0) <= 0) return 0;
  double low = 1e-7, high = kMostRepeatability_rad;
  for (int i = 0; i < 18; ++i) {
    const double middle = std::sqrt(low * high);
    (excess(middle) > 0 ? low : high) = middle;
  }
  return high;
}

/// Direction and a point of an axis in base axes, from the head's place at two angles.
calibration_file::PanTilt::Axis axis_of(const estimation::PanTiltChain& chain, bool pan) {
  const geometry::Pose zero = estimation::base_from_head(chain, 0, 0);
  const geometry::Pose turned = estimation::base_from_head(chain, pan ? 0.1 : 0, pan ? 0 : 0.1);
  calibration_file::PanTilt::Axis axis;
  axis.direction =
      estimation::rotation_log((turned.rotation * zero.rotation.conjugate()).normalized())
          .normalized();
  axis.point_m = pan ? Eigen::Vector3d::Zero() : zero.translation_m;
  axis.scale = pan ? chain.pan_scale : chain.tilt_scale;
  return axis;
}

double chain_residual_px(const RigData& data, const RigModel& model, const Poses& poses,
                         const estimation::PanTiltCalibration& solved) {
  RigModel moved = model;
  for (std::size_t i = 0; i < poses.views.size(); ++i)
    moved.target_from_board[poses.views[i]] =
        geometry::inverse(estimation::base_from_camera(solved.chain, poses.chain[i].pan_rad,
                                                       poses.chain[i].tilt_rad)) *
        solved.base_from_target;
  return corner_error(data, moved, 0, poses.views).rms_px;
}

Result<RigModel> model_with(RigData& data, const PtuOptions& options, PtuReport& report,
                            Crew& crew) {
  if (!options.lens) {
    report.warnings.push_back(
        "the lens is solved from the same views, which see the board from one distance: give "
        "--calibration with this camera for an exact tool centre point");
    return start_rig(data, crew);
  }
  RigModel model;
  model.square_m = data.set.square_m;
  model.target_from_board.resize(data.corners.size());
  RigCamera camera;
  camera.name = data.set.cameras[0].name;
  camera.lens = geometry::kind_of(*options.lens);
  camera.size_px = geometry::size_px(*options.lens);
  camera.parameters = geometry::parameters_of(*options.lens);
  if (camera.size_px != data.set.cameras[0].size_px)
    return Error{ErrorCode::kUsage, "camera \"" + camera.name +
                                        "\" of the calibration has another size than the views: "
                                        "are cameras swapped?"};
  model.cameras.push_back(camera);
  return model;
}

}  // namespace

Result<PtuReport> calibrate_ptu(const ViewSet& set, const PtuOptions& options,
                                const RigProgress& progress) {
  if (set.angles.empty())
    return Error{ErrorCode::kUsage, (set.folder / "views.toml").string() +
                                        ": there are no angles of a pan-tilt unit: add [pan_tilt]"};
  Crew crew(options.threads);
  PtuReport report;
  const std::string camera = options.camera.empty() ? set.cameras[0].name : options.camera;
  MIXRIG_ASSIGN(RigData data, load_rig_data(set, {camera}, crew, [&](int done, int total) {
                  progress("views", done, total);
                }));
  MIXRIG_ASSIGN(RigModel model, model_with(data, options, report, crew));
  double sigma_px = 0;
  const Poses poses = measure(data, model, sigma_px, crew);
  if (picture_turns_per_angle(poses) > kMostTurns)
    return Error{ErrorCode::kData,
                 set.folder.string() +
                     ": the pictures turn far more than the angles say: they are "
                     "radians, where degrees are wanted: multiply them by 57.29578"};
  report.repeatability_rad = find_repeatability(poses);
  const auto found = estimation::calibrate_pan_tilt(poses.chain, report.repeatability_rad);
  if (!found.usable())
    return Error{ErrorCode::kData,
                 "the views do not determine the pan-tilt unit: " + found.verdict.reason +
                     ": turn both axes by 10 degrees and more, with the board in "
                     "the picture"};
  if (found.verdict.standing == estimation::Standing::kWeak)
    report.warnings.push_back(found.verdict.reason);
  if (report.repeatability_rad > 0.99 * kMostRepeatability_rad)
    return Error{ErrorCode::kData,
                 "poses and angles contradict each other: did the board or the foot of the unit "
                 "move, or are pan and tilt swapped?"};
  report.solved = found.value;
  report.covariance = found.covariance;
  report.views = static_cast<int>(poses.views.size());
  report.residual_px = chain_residual_px(data, model, poses, found.value);
  calibration_file::PanTilt& unit = report.calibration.pan_tilt.emplace();
  unit.pan = axis_of(found.value.chain, true), unit.tilt = axis_of(found.value.chain, false);
  unit.pan.step_rad = unit.tilt.step_rad = set.step_rad;
  unit.head_from_target = estimation::base_from_camera(found.value.chain, 0, 0);
  unit.repeatability_rad = report.repeatability_rad;
  unit.covariance = found.covariance;
  unit.residual_px = report.residual_px, unit.views = report.views;
  return report;
}

}  // namespace mixrig::calibration
