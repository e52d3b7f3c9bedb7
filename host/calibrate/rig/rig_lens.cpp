// SPDX-License-Identifier: Apache-2.0
// One camera alone: its lens and the board's poses from corners.
#include "host/calibrate/rig/rig_lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <opencv2/calib3d.hpp>

#include "hal/base/order_statistics.h"

namespace mixrig::calibration {
namespace {

constexpr double kMostResidual = 0.004;  // of the picture's width: no lens explains the corners
constexpr double kOutlierSigmas = 5, kBadView = 8, kFloor_px = 0.005;
constexpr std::size_t kLeastCorners = 8;
constexpr int kRounds = 4;
constexpr double kAsGood = 1.005;  // held-out error of a simpler lens, as a multiple of the least

double miss_of(const RigCamera& camera, double square_m, const std::vector<SeenCorner>& corners,
               const geometry::Pose& pose) {
  double squares = 0;
  for (const SeenCorner& corner : corners) {
    const Eigen::Vector3d p(square_m * corner.uv.x(), square_m * corner.uv.y(), 0);
    const auto seen =
        geometry::project_with_jacobians(camera.lens, camera.parameters.data(), pose * p);
    squares += seen ? std::min((seen->px - corner.px).squaredNorm(), 1e6) : 1e6;
  }
  return squares;
}

geometry::Pose pose_of(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  const Eigen::Vector3d w(rotation_vector.at<double>(0), rotation_vector.at<double>(1),
                          rotation_vector.at<double>(2));
  const Eigen::Quaterniond q = w.norm() > 0
                                   ? Eigen::Quaterniond(Eigen::AngleAxisd(w.norm(), w.normalized()))
                                   : Eigen::Quaterniond::Identity();
  return {q, {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)}};
}

RigCamera camera_with(const ViewCamera& camera, double f_px) {
  RigCamera out;
  out.name = camera.name, out.lens = camera.lens, out.size_px = camera.size_px;
  out.parameters = Eigen::VectorXd::Zero(geometry::parameter_count(camera.lens));
  out.parameters.head<4>() << f_px, f_px, 0.5 * (camera.size_px.width - 1),
      0.5 * (camera.size_px.height - 1);
  out.free.resize(4);
  std::iota(out.free.begin(), out.free.end(), 0);
  return out;
}

std::vector<double> likely_focals(const ViewCamera& camera) {
  std::vector<double> f;
  const double side = camera.lens == geometry::LensKind::kFisheye
                          ? std::min(camera.size_px.width, camera.size_px.height) / std::numbers::pi
                          : camera.size_px.width;
  for (double factor = 0.45; factor < 3.2; factor *= 1.18) f.push_back(factor * side);
  return f;
}

/// Focal length under which the poses explain the corners best, and those poses.
double scan_focals(const RigData& data, std::size_t camera, const std::vector<int>& views,
                   RigModel& model) {
  double least = 1e300;
  for (const double f : likely_focals(data.set.cameras[camera])) {
    RigModel tried = model;
    tried.cameras = {camera_with(data.set.cameras[camera], f)};
    double sum = 0;
    for (const int view : views) {
      const auto& corners = data.corners[view][camera];
      geometry::Pose& pose = tried.target_from_board[view];
      const double miss = pose_of_corners(tried.cameras[0], tried.square_m, corners, pose)
                              ? miss_of(tried.cameras[0], tried.square_m, corners, pose)
                              : 1e6;
      sum += std::sqrt(miss /
                       static_cast<double>(corners.size()));  // not squared: robust to bad views
    }
    if (sum < least) least = sum, model = tried;
  }
  return least / static_cast<double>(views.size());
}

/// Distances of a view's corners to their projections, px.
std::vector<double> distances_of(const RigData& data, const RigModel& single, std::size_t camera,
                                 int view) {
  std::vector<double> all;
  for (const SeenCorner& corner : data.corners[view][camera])
    all.push_back(std::sqrt(
        miss_of(single.cameras[0], single.square_m, {corner}, single.target_from_board[view])));
  return all;
}
std::vector<double> distances(const RigData& data, const RigModel& single, std::size_t camera,
                              const std::vector<int>& views) {
  std::vector<double> all;
  for (const int view : views)
    for (const double d : distances_of(data, single, camera, view)) all.push_back(d);
  return all;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// Removes false detections: views whose median is far beyond that of all, and corners
/// far beyond their view's (Rayleigh: median = 1.1774 sigma). True where there was any.
bool drop_misfound(RigData& data, const RigModel& single, std::size_t camera,
                   const std::vector<int>& views) {
  const double typical = std::max(upper_median(distances(data, single, camera, views)), kFloor_px);
  bool any = false;
  for (const int view : views) {
    const std::vector<double> away = distances_of(data, single, camera, view);
    const double own = std::max(upper_median(away), typical), gate = kOutlierSigmas / 1.1774 * own;
    std::vector<SeenCorner>& corners = data.corners[view][camera];
    std::vector<SeenCorner> kept;
    for (std::size_t i = 0; i < away.size(); ++i)
      if (away[i] < gate) kept.push_back(corners[i]);
    const bool drop = own > kBadView * typical || kept.size() < kLeastCorners;
    if (kept.size() == corners.size() && !drop) continue;
    any = true;
    if (drop) kept.clear();
    Misfound& wrong = data.misfound[camera];
    wrong.corners += static_cast<int>(corners.size() - kept.size());
    if (drop) wrong.views.push_back(view);
    corners = std::move(kept);
  }
  return any;
}

/// This camera's corners alone, as a rig of one.
SeenCorners only(const SeenCorners& corners, std::size_t camera) {
  SeenCorners out;
  for (const auto& view : corners) out.push_back({view[camera]});
  return out;
}

/// Numbers of parameters that are tried, the richest lens first; k4 to k6 of a pinhole stay zero.
std::vector<int> lens_counts(geometry::LensKind kind) {
  return kind == geometry::LensKind::kPinhole ? std::vector{9, 8, 6, 4} : std::vector{8, 6};
}

/// True where the lens is implausible in parts of the image that no view covers.
bool folds(const RigCamera& camera, const std::optional<ImageCircle>& circle) {
  const auto lens = geometry::make_camera(camera.lens, camera.size_px, camera.parameters);
  return circle ? !rim_angle_rad(lens, *circle) : !geometry::validate(lens);
}

SolveReport solve_free(const RigData& data, std::size_t camera, const std::vector<int>& views,
                       int count, double sigma_px, RigModel& model, Crew& crew) {
  model.cameras[0].free.resize(count);
  std::iota(model.cameras[0].free.begin(), model.cameras[0].free.end(), 0);
  const SeenCorners corners = only(data.corners, camera);
  return solve_views(model, layout_of(model, {}), corner_terms(data.print, corners, {sigma_px}),
                     views, {40, 1e-3, {}}, crew);
}

/// Error on views that are left out of the fit, five folds; infinity where a fold is not solved.
double held_out_px(const RigData& data, std::size_t camera, const std::vector<int>& views,
                   const RigModel& solved, Crew& crew) {
  constexpr std::size_t kFolds = 5;
  std::vector<double> away;
  const int count = static_cast<int>(solved.cameras[0].free.size());
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<int> fitted, held;
    for (std::size_t i = 0; i < views.size(); ++i)
      (i % kFolds == fold ? held : fitted).push_back(views[i]);
    RigModel fit = solved;
    if (!solve_free(data, camera, fitted, count, 0.1, fit, crew).solved)
      return std::numeric_limits<double>::infinity();
    fit.cameras[0].free.clear();
    for (const int view : held)
      solve_views(fit, layout_of(fit, {}),
                  corner_terms(data.print, only(data.corners, camera), {0.1}), {view},
                  {20, 1e-3, {}}, crew);
    for (const double d : distances(data, fit, camera, held)) away.push_back(d);
  }
  return std::sqrt(mean_square(away));
}

/// Takes the lens with the least error on views left out; of those that are as good, the simplest.
/// A lens that folds inside the picture is not taken unless all do. `model` is the richest, solved.
SolveReport choose_lens(const RigData& data, std::size_t camera, const std::vector<int>& views,
                        const SolveReport& richest, RigModel& model, Crew& crew) {
  struct Candidate {
    RigModel model;
    SolveReport report;
    double held_px = 0;
  };
  std::vector<Candidate> found;
  double least = std::numeric_limits<double>::infinity();
  for (const int count : lens_counts(model.cameras[0].lens)) {
    Candidate tried{model, richest, 0};
    Eigen::VectorXd& parameters = tried.model.cameras[0].parameters;
    if (count < static_cast<int>(model.cameras[0].free.size())) {
      parameters.tail(parameters.size() - count).setZero();
      tried.report = solve_free(data, camera, views, count, 0.1, tried.model, crew);
    }
    if (!tried.report.solved || folds(tried.model.cameras[0], circle_of(data, camera))) continue;
    tried.held_px = held_out_px(data, camera, views, tried.model, crew);
    least = std::min(least, tried.held_px);
    found.push_back(std::move(tried));
  }
  SolveReport report = richest;
  for (const Candidate& c : found)
    if (c.held_px <= kAsGood * least) model = c.model, report = c.report;
  return report;
}

}  // namespace

bool pose_of_corners(const RigCamera& camera, double square_m,
                     const std::vector<SeenCorner>& corners, geometry::Pose& camera_from_board) {
  const auto lens = geometry::make_camera(camera.lens, camera.size_px, camera.parameters);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const SeenCorner& corner : corners) {
    const auto ray = geometry::unproject(lens, corner.px);
    if (!ray || ray->z() < std::cos(80 * std::numbers::pi / 180) * ray->norm()) continue;
    points.emplace_back(square_m * corner.uv.x(), square_m * corner.uv.y(), 0);
    rays.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
  }
  if (points.size() < 6) return false;
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(points, rays, cv::Matx33d::eye(), cv::noArray(), rotations, translations,
                        false, cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return false;
  }
  double least = 1e300;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const geometry::Pose pose = pose_of(rotations[i], translations[i]);
    const double miss = miss_of(camera, square_m, corners, pose);
    if (pose.translation_m.allFinite() && miss < least) least = miss, camera_from_board = pose;
  }
  return least < 1e300;
}

Result<RigModel> solve_lens(RigData& data, std::size_t camera, Crew& crew) {
  RigModel model;
  model.square_m = data.set.square_m;
  model.target_from_board.resize(data.corners.size());
  std::vector<int> views = seen_by(data, camera);
  const std::size_t found = views.size();
  scan_focals(data, camera, views, model);
  // First the focal length and the poses, then the lens.
  const int most = lens_counts(data.set.cameras[camera].lens).front();
  SolveReport report;
  for (const int count : {4, 6, most})
    report = solve_free(data, camera, views, count, count < most ? 1.0 : 0.1, model, crew);
  for (int round = 0; round < kRounds && drop_misfound(data, model, camera, views); ++round) {
    views = seen_by(data, camera);
    report = solve_free(data, camera, views, most, 0.1, model, crew);
  }
  report = choose_lens(data, camera, views, report, model, crew);
  const double rms = std::sqrt(mean_square(distances(data, model, camera, views)));
  const double allowed = std::max(0.7, kMostResidual * model.cameras[0].size_px.width);
  const bool sane = model.cameras[0].parameters.allFinite() && model.cameras[0].parameters[0] > 0;
  if (sane && report.solved && rms < allowed && 2 * views.size() > found) return model;
  return Error{ErrorCode::kData,
               "camera \"" + model.cameras[0].name + "\": no " +
                   std::string(geometry::name_of(model.cameras[0].lens)) +
                   " lens explains the corners (" + std::to_string(rms) + " px in " +
                   std::to_string(views.size()) + " of " + std::to_string(found) +
                   " views): check model, the board's columns and rows, and that the pictures are "
                   "this camera's"};
}

}  // namespace mixrig::calibration
