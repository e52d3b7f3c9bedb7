// SPDX-License-Identifier: Apache-2.0
// Joint calibration of all cameras of a rig.
#include "host/calibrate/rig/calibrate_rig.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

constexpr int kHoldOutEvery = 4;
constexpr double kKnotStep_m = 0.06;  // an 80 MHz camera's error has a period of 0.47 m
constexpr double kStretchWarned = 0.012, kStretchRefused = 0.03;
constexpr double kBlurWarned_px = 3, kFarWarned_m = 1;
constexpr int kPixelSteps = 10, kStepsFromNear = 3;
constexpr double kBendSigmas = 5, kLeastBend_m = 2e-4;

class Stopwatch {
 public:
  double seconds() {
    const auto now = std::chrono::steady_clock::now();
    const double passed = std::chrono::duration<double>(now - since_).count();
    since_ = now;
    return passed;
  }

 private:
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
};

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string millimetres(double length_m) { return fmt::format("{:.2f} mm", 1000 * length_m); }

using Views = std::vector<int>;

/// Views that take part: all, those of the first fit, and those held out to judge it.
struct Split {
  Views all, fitted, held;
};

std::vector<int> all_seen(const RigData& data) {
  std::vector<int> views;
  for (std::size_t v = 0; v < data.corners.size(); ++v)
    for (const auto& corners : data.corners[v])
      if (!corners.empty()) {
        views.push_back(static_cast<int>(v));
        break;
      }
  return views;
}

/// Every fourth of the views that the target camera shares with another.
std::vector<int> hold_out(const RigData& data) {
  std::vector<int> shared, held;
  for (const int view : seen_by(data, 0)) {
    bool with_other = false;
    for (std::size_t c = 1; c < data.corners[view].size(); ++c)
      with_other = with_other || !data.corners[view][c].empty();
    if (with_other) shared.push_back(view);
  }
  if (shared.size() < 8) return {};
  for (std::size_t i = 1; i < shared.size(); i += kHoldOutEvery) held.push_back(shared[i]);
  return held;
}

std::vector<int> without(const std::vector<int>& views, const std::vector<int>& left_out) {
  std::vector<int> rest;
  for (const int v : views)
    if (std::find(left_out.begin(), left_out.end(), v) == left_out.end()) rest.push_back(v);
  return rest;
}

std::vector<double> corner_sigmas(const RigData& data, const RigModel& model,
                                  const std::vector<int>& views) {
  std::vector<double> sigma;
  for (std::size_t c = 0; c < model.cameras.size(); ++c)
    sigma.push_back(std::max(corner_error(data, model, c, views).rms_px / std::sqrt(2.0), 0.005));
  return sigma;
}

/// Corners of all cameras together; the second round uses the scatter of each camera's corners.
SolveReport solve_corners(const RigData& data, RigModel& model, const std::vector<int>& views,
                          bool bend, Crew& crew) {
  const RigLayout layout = layout_of(model, {false, bend, false});
  std::vector<double> sigma(model.cameras.size(), 0.2);
  SolveReport report;
  for (int round = 0; round < 2; ++round) {
    report = solve_views(model, layout, corner_terms(data.print, data.corners, sigma), views,
                         {40, 1e-3, {}}, crew);
    sigma = corner_sigmas(data, model, views);
  }
  return report;
}

/// True where a bent board explains the corners significantly better; adds a warning.
bool is_bent(const RigData& data, const RigModel& model, const Views& views, RigReport& report,
             Crew& crew) {
  RigModel tried = model;
  const SolveReport solved = solve_corners(data, tried, views, true, crew);
  if (!solved.solved) return false;
  const int at = layout_of(tried, {false, true, false}).bend;
  const Eigen::Matrix3d information = solved.covariance.block<3, 3>(at, at).inverse();
  const double sigmas = std::sqrt(tried.bend.dot(information * tried.bend));
  if (!(sigmas > kBendSigmas && tried.bend.norm() > kLeastBend_m)) return false;
  report.warnings.push_back("the board is bent by " + millimetres(tried.bend.norm()) +
                            ": the bend is solved for, but a flat board is better");
  return true;
}

bool has_depth(const RigData& data) {
  for (const ViewCamera& camera : data.set.cameras)
    if (!camera.depth.empty()) return true;
  return false;
}

/// A point of the board in a camera's axes; unset where it is out of the picture.
std::optional<Eigen::Vector3d> place_of(const RigData& data, const RigModel& model, std::size_t c,
                                        int view, const Eigen::Vector2d& uv) {
  const RigCamera& camera = model.cameras[c];
  const BoardPoint p = board_point(model, data.print.columns, data.print.rows, uv);
  const Eigen::Vector3d at = camera.camera_from_target * (model.target_from_board[view] * p.p_m);
  const auto seen = geometry::project_with_jacobians(camera.lens, camera.parameters.data(), at);
  if (!seen || !(seen->px.minCoeff() >= 0) || !(seen->px.x() < camera.size_px.width) ||
      !(seen->px.y() < camera.size_px.height))
    return std::nullopt;
  return at;
}

/// Knots over the distances at which the depth camera sees the board, detected or not: a curve that
/// ends earlier would bias the poses beyond its end.
DepthCurve empty_curve(const RigData& data, const RigModel& model, const std::vector<int>& views) {
  double low = 1e9, high = 0;
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    if (data.set.cameras[c].depth.empty()) continue;
    for (const int view : views)
      for (const double u : {0.0, 0.5, 1.0})
        for (const double v : {0.0, 0.5, 1.0}) {
          const Eigen::Vector2d uv(u * data.print.columns, v * data.print.rows);
          const auto place = place_of(data, model, c, view, uv);
          if (!place) continue;
          low = std::min(low, place->norm()), high = std::max(high, place->norm());
        }
  }
  DepthCurve curve;
  if (high <= low) return curve;
  // One knot beyond each end: a natural spline is straight there, the error is not.
  const int pieces = std::clamp(static_cast<int>((high - low) / kKnotStep_m), 1, 50);
  for (int k = -1; k <= pieces + 1; ++k) curve.knots_m.push_back(low + (high - low) * k / pieces);
  curve.error_m.assign(curve.knots_m.size(), 0.0);
  return curve;
}

/// `first_steps`: most steps of the first round.
SolveReport solve_pixels(RigModel& model, const std::vector<int>& views, bool bend, int first_steps,
                         PixelTerms& terms, Crew& crew) {
  SolveReport report;
  // The first round's scatter includes errors of the corner step, the second's only the pictures'
  // noise.
  for (int round = 0; round < 2; ++round) {
    terms.weigh(model, views, crew);
    const RigLayout layout = layout_of(model, {true, bend, model.depth.knots_m.size() > 1});
    SolveOptions options{round == 0 ? first_steps : kPixelSteps, 0.1,
                         Eigen::VectorXd::Zero(layout.count)};
    if (layout.depth >= 0)  // a piece of the curve that no view reaches stays where it is
      options.prior.segment(layout.depth, static_cast<Eigen::Index>(model.depth.knots_m.size()))
          .setConstant(1e4);
    report = solve_views(model, layout, terms.function(), views, options, crew);
  }
  return report;
}

/// First without the views held out (`judged` becomes the model of that fit), then with all.
SolveReport refine_by_pixels(const RigData& data, const Split& split, bool bend, RigModel& judged,
                             RigReport& report, Crew& crew) {
  PixelTerms terms(data.print, data.pictures);
  RigModel& model = report.model;
  if (has_depth(data)) judged.depth = empty_curve(data, model, split.all);
  if (!split.held.empty()) {
    solve_pixels(judged, split.fitted, bend, kPixelSteps, terms, crew);
    // All views start from that fit: its lens and mounting are close, the other views' poses are
    // not.
    model.cameras = judged.cameras;
    model.bend = judged.bend;
    for (const int view : split.fitted)
      model.target_from_board[view] = judged.target_from_board[view];
    const auto poses = refined_poses(data, model, 0, split.held, 0.1, crew);
    for (const int view : split.held)
      if (poses[view]) model.target_from_board[view] = *poses[view];
  }
  model.depth = judged.depth;
  const int first_steps = split.held.empty() ? kPixelSteps : kStepsFromNear;
  const SolveReport solved = solve_pixels(model, split.all, bend, first_steps, terms, crew);
  for (std::size_t c = 0; c < model.cameras.size(); ++c)
    report.grey_rms.push_back(terms.grey_rms(static_cast<int>(c)));
  return solved;
}

std::vector<HeldOut> judge_held_out(const RigData& data, const RigModel& by_corners,
                                    const RigModel& by_pixels, const std::vector<int>& held,
                                    Crew& crew) {
  std::vector<HeldOut> out;
  for (std::size_t c = 1; c < by_corners.cameras.size(); ++c) {
    HeldOut h;
    h.camera = by_corners.cameras[c].name;
    for (const RigModel* fitted : {&by_corners, &by_pixels}) {
      RigModel moved = *fitted;
      const auto poses = refined_poses(data, moved, 0, held, 0.1, crew);
      for (const int view : held)
        if (poses[view]) moved.target_from_board[view] = *poses[view];
      const CornerError error = corner_error(data, moved, c, held);
      (fitted == &by_corners ? h.corners_px : h.pixels_px) = error.rms_px;
      h.views = error.views;
    }
    out.push_back(h);
  }
  return out;
}

/// Covariance of target_from_camera from that of camera_from_target.
Eigen::MatrixXd inverse_covariance(const geometry::Pose& pose, const Eigen::MatrixXd& covariance) {
  const Eigen::Matrix3d back = pose.rotation.toRotationMatrix().transpose();
  Eigen::Matrix<double, 6, 6> j = Eigen::Matrix<double, 6, 6>::Zero();
  j.topLeftCorner<3, 3>() = -back;
  j.bottomLeftCorner<3, 3>() = -back * estimation::skew(pose.translation_m);
  j.bottomRightCorner<3, 3>() = -back;
  return j * covariance * j.transpose();
}

void fill_calibration(const RigData& data, const SolveReport& solved, const RigLayout& layout,
                      const std::vector<int>& views, RigReport& report) {
  for (std::size_t c = 0; c < report.model.cameras.size(); ++c) {
    const RigCamera& camera = report.model.cameras[c];
    const CornerError error = corner_error(data, report.model, c, views);
    calibration_file::CalibratedCamera out;
    out.name = camera.name;
    out.model = geometry::make_camera(camera.lens, camera.size_px, camera.parameters);
    if (const auto circle = circle_of(data, c))
      if (const auto angle = rim_angle_rad(out.model, *circle))
        out.model = geometry::make_camera(camera.lens, camera.size_px, camera.parameters, *angle);
    const auto count = static_cast<Eigen::Index>(camera.parameters.size());
    out.covariance = Eigen::MatrixXd::Zero(count, count);
    for (std::size_t i = 0; i < camera.free.size(); ++i)
      for (std::size_t j = 0; j < camera.free.size(); ++j)
        out.covariance(camera.free[i], camera.free[j]) =
            solved.covariance(layout.cameras[c].intrinsics + static_cast<int>(i),
                              layout.cameras[c].intrinsics + static_cast<int>(j));
    out.residual_px = error.rms_px, out.views = error.views, out.points = error.corners;
    report.calibration.cameras.push_back(out);
    if (c == 0) continue;
    const int at = layout.cameras[c].extrinsics;
    report.calibration.poses.push_back(
        {camera.name,
         geometry::inverse(camera.camera_from_target),
         inverse_covariance(camera.camera_from_target, solved.covariance.block(at, at, 6, 6)),
         error.rms_px,
         error.views,
         {}});
  }
}

Result<void> fit_depth(const RigData& data, const std::vector<int>& views, RigReport& report) {
  for (std::size_t c = 0; c < data.set.cameras.size(); ++c) {
    if (data.set.cameras[c].depth.empty()) continue;
    MIXRIG_ASSIGN(DepthFit fit, fit_depth_error(depth_samples(data.print, data.pictures,
                                                              report.model, c, views)));
    fit.error.camera = data.set.cameras[c].name;
    const bool second = fit.error.camera == kSecondDepthCamera;
    (second ? report.calibration.depth_error2 : report.calibration.depth_error) = fit.error;
    report.depth = std::move(fit);
    return {};
  }
  return {};
}

/// A wrong size of the board scales the mounting without residuals: only depth can reveal it.
Result<void> check_result(const RigData& data, RigReport& report) {
  for (const calibration_file::CalibratedCamera& camera : report.calibration.cameras)
    if (const auto sane = geometry::validate(camera.model); !sane)
      return Error{ErrorCode::kData, "camera \"" + camera.name + "\": " + sane.error().context +
                                         ": show it the board near the sides of its picture"};
  if (report.depth && std::abs(report.depth->stretch) > kStretchRefused)
    return Error{ErrorCode::kData, "the depth camera measures distances that differ by " +
                                       percent(report.depth->stretch) +
                                       " of what the board's size says: the square is not " +
                                       std::to_string(1000 * data.set.square_m) +
                                       " mm: measure it and correct square_mm in views.toml"};
  if (report.depth && std::abs(report.depth->stretch) > kStretchWarned)
    report.warnings.push_back("depth differs by " + percent(report.depth->stretch) +
                              " of the distance: measure the board's square again");
  for (const calibration_file::CalibratedPose& pose : report.calibration.poses)
    if (const double away_m = pose.target_from.translation_m.norm(); away_m > kFarWarned_m)
      report.warnings.push_back(
          fmt::format("the cameras \"{}\" and \"{}\" stand {:.2f} m apart: if that is wrong, "
                      "measure the board's square and correct square_mm in views.toml",
                      report.model.cameras[0].name, pose.name, away_m));
  if (data.blur_px > kBlurWarned_px)
    report.warnings.push_back("some views are blurred: hold the board still, and in focus");
  for (std::size_t c = 0; c < report.corner_px.size(); ++c)
    if (report.corner_px[c] > 1.0)
      report.warnings.push_back("camera \"" + report.model.cameras[c].name +
                                "\": corners are off by " + std::to_string(report.corner_px[c]) +
                                " px: is the board flat, and did it stand still?");
  return {};
}

}  // namespace

std::vector<std::optional<geometry::Pose>> refined_poses(const RigData& data, const RigModel& model,
                                                         std::size_t camera,
                                                         const std::vector<int>& views,
                                                         double sigma_px, Crew& crew) {
  std::vector<std::optional<geometry::Pose>> poses(data.corners.size());
  RigModel single = model;
  single.cameras = {model.cameras[camera]};
  single.cameras[0].free.clear();
  single.cameras[0].camera_from_target = {};
  SeenCorners corners;
  for (const auto& view : data.corners) corners.push_back({view[camera]});
  std::vector<int> seen;
  for (const int view : views)
    if (board_pose(data, model, camera, view, single.target_from_board[view])) seen.push_back(view);
  const RigLayout layout = layout_of(single, {});
  for (const int view : seen) {
    solve_views(single, layout, corner_terms(data.print, corners, {sigma_px}), {view},
                {20, 1e-3, {}}, crew);
    poses[view] = single.target_from_board[view];
  }
  return poses;
}

Result<RigReport> calibrate_rig(const ViewSet& set, const RigOptions& options,
                                const RigProgress& progress) {
  Crew crew(options.threads);
  RigReport report;
  Stopwatch watch;
  MIXRIG_ASSIGN(RigData data, load_rig_data(set, options.cameras, crew, [&](int done, int total) {
                  progress("views", done, total);
                }));
  report.load_s = watch.seconds();
  MIXRIG_ASSIGN(RigModel model, start_rig(data, crew));
  report.misfound = data.misfound;
  report.first_is_white = data.print.first_is_white;
  const std::vector<int> views = all_seen(data), held = hold_out(data);
  const Split split{views, without(views, held), model.cameras.size() > 1 ? held : Views{}};
  const bool bend = options.bend || is_bent(data, model, views, report, crew);

  RigModel judged = model;
  if (!split.held.empty()) solve_corners(data, judged, split.fitted, bend, crew);
  report.by_corners = model;
  SolveReport solved = solve_corners(data, report.by_corners, views, bend, crew);
  if (!solved.solved)
    return Error{
        ErrorCode::kData,
        "the views do not determine a calibration: hold the board near and far, tilted to all "
        "sides, and in all parts of the pictures"};
  for (std::size_t c = 0; c < model.cameras.size(); ++c)
    report.corner_px.push_back(corner_error(data, report.by_corners, c, views).rms_px);
  report.model = report.by_corners;
  report.corners_s = watch.seconds();
  progress("corners", 1, 1);

  RigModel judged_pixels = judged;
  if (options.pixels) solved = refine_by_pixels(data, split, bend, judged_pixels, report, crew);
  if (!solved.solved)
    return Error{ErrorCode::kData, "the pictures do not determine a calibration: add views"};
  progress("pixels", 1, 1);
  report.pixels_s = watch.seconds();
  if (!split.held.empty())
    report.held_out = judge_held_out(data, judged, judged_pixels, split.held, crew);
  const RigSwitches switches{options.pixels, bend, report.model.depth.knots_m.size() > 1};
  const RigLayout layout = layout_of(report.model, switches);
  fill_calibration(data, solved, layout, views, report);
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    report.alone.push_back(seen_alone(data, report.model, c, views));
    if (c > 0)
      report.registrations.push_back(
          registration_of(report.model, layout, solved.covariance, c, views));
  }
  if (has_depth(data)) MIXRIG_TRY(fit_depth(data, views, report));
  MIXRIG_TRY(check_result(data, report));
  return report;
}

}  // namespace mixrig::calibration
