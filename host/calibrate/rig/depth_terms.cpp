// SPDX-License-Identifier: Apache-2.0
// Residuals of the depth pictures of a view.
#include "host/calibrate/rig/depth_terms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/LU>

#include "hal/base/order_statistics.h"

namespace mixrig::calibration {
namespace {

constexpr double kDepthHuber = 3;  // sigmas

/// Spline basis by distance, tabulated.
class Basis {
 public:
  explicit Basis(const std::vector<double>& knots) : first_(knots.front() - 0.3) {
    const int rows = static_cast<int>((knots.back() + 0.3 - first_) / kStep) + 2;
    table_.resize(static_cast<Eigen::Index>(knots.size()), rows);
    Eigen::VectorXd values;
    for (int i = 0; i < rows; ++i) {
      spline_basis(knots, first_ + kStep * i, values);
      table_.col(i) = values;
    }
  }
  /// Writes the basis at a distance, and how it changes with it.
  void at(double distance_m, Eigen::VectorXd& values, Eigen::VectorXd& slopes) const {
    const double place =
        std::clamp((distance_m - first_) / kStep, 0.0, static_cast<double>(table_.cols()) - 1.001);
    const auto i = static_cast<Eigen::Index>(place);
    slopes = (table_.col(i + 1) - table_.col(i)) / kStep;
    values = table_.col(i) + (place - static_cast<double>(i)) * kStep * slopes;
  }

 private:
  static constexpr double kStep = 0.005;
  double first_;
  Eigen::MatrixXd table_;
};

/// Depth residual of a sample: board + curve(board) - measured. The curve is evaluated at the
/// model's distance of the board: at the measured distance its slope would correlate with the noise
/// and bias the fit.
struct DepthMiss {
  double miss_m = 0;
  double gain = 1;  ///< change of the residual with the distance
  Eigen::VectorXd basis, slopes;
  Eigen::Vector3d sight;  ///< unit, camera to point, board axes
};

bool depth_miss(const Scene& scene, const Basis& basis, const Eigen::VectorXd& error_m,
                const Sample& s, const ViewPictures& seen, DepthMiss& out) {
  const double depth_m = seen.depth_m.at(s.x, s.y);
  if (depth_m <= 0) return false;
  const Eigen::Vector3d point =
      board_point(scene.model, scene.print.columns, scene.print.rows, s.uv).p_m;
  const double value = along_ray(scene, seen, depth_m, point);
  const Eigen::Vector3d way = point - scene.eye;
  const double distance = way.norm();
  out.sight = way / distance;
  basis.at(distance, out.basis, out.slopes);
  out.miss_m = distance + error_m.dot(out.basis) - value;
  out.gain = 1 + error_m.dot(out.slopes);
  return std::abs(out.miss_m) < 0.15;
}

Eigen::VectorXd errors_of(const RigModel& model) {
  return Eigen::Map<const Eigen::VectorXd>(model.depth.error_m.data(),
                                           static_cast<Eigen::Index>(model.depth.error_m.size()));
}

/// Sigma of depth on one colour, robust: 1.4826 times the median of absolute differences.
double scatter_m(std::vector<double>& misses) {
  if (misses.size() < 20) return 0.01;
  const double center = upper_median_in_place(std::span(misses));
  for (double& m : misses) m = std::abs(m - center);
  return std::max(1.4826 * upper_median_in_place(std::span(misses)), 2e-4);
}

}  // namespace

double along_ray(const Scene& scene, const ViewPictures& seen, double depth_m,
                 const Eigen::Vector3d& point_m) {
  if (!seen.depth_is_z) return depth_m;
  const Eigen::Vector3d way = scene.r * (point_m - scene.eye);  // camera axes
  return way.z() > 0 ? depth_m * way.norm() / way.z() : 0;
}

DepthScatter depth_scatter(const Scene& scene, const std::vector<Sample>& samples,
                           const ViewPictures& seen) {
  const Basis basis(scene.model.depth.knots_m);
  std::vector<double> paper, ink;
  DepthMiss d;
  for (const Sample& s : samples)
    if (depth_miss(scene, basis, errors_of(scene.model), s, seen, d))
      (s.ink < 0.5 ? paper : ink).push_back(d.miss_m);
  return {scatter_m(paper), scatter_m(ink)};
}

Eigen::MatrixXd depth_sums(const Scene& scene, const std::vector<Sample>& samples,
                           const ViewPictures& seen, const DepthScatter& scatter,
                           const CameraColumns& at, long& rows) {
  const Basis basis(scene.model.depth.knots_m);
  const Eigen::VectorXd errors = errors_of(scene.model);
  RowSum sum(at.count);
  ProjectedBoardPoint projected;
  DepthMiss d;
  for (const Sample& s : samples) {
    if (!depth_miss(scene, basis, errors, s, seen, d) ||
        !project_board_point(scene, s.uv, projected))
      continue;
    const double sigma = scatter.paper_m + s.ink * (scatter.ink_m - scatter.paper_m);
    const double miss = d.miss_m / sigma;
    const double scale = std::abs(miss) > kDepthHuber ? std::sqrt(kDepthHuber / std::abs(miss)) : 1;
    auto row = sum.next();
    const BoardPoint point = board_point(scene.model, scene.print.columns, scene.print.rows, s.uv);
    // The ray of the pixel is fixed: the board point on it slides over the board as the board
    // moves.
    const Eigen::RowVector2d by_uv = d.sight.transpose() * point.d_uv;
    add_motion(scene, projected, s.uv, -by_uv * projected.px_by_uv.inverse(), at, row);
    // and the point itself moves along the ray.
    const Eigen::Vector3d sight_target = scene.target_from_board.rotation * d.sight;
    const Eigen::Vector3d sight_camera = scene.r * d.sight;
    const Eigen::Vector3d turned = scene.camera.camera_from_target.rotation * projected.in_target;
    const Eigen::Vector3d about = projected.in_target - scene.target_from_board.translation_m;
    row.segment<3>(at.extrinsics) += turned.cross(sight_camera);
    row.segment<3>(at.extrinsics + 3) += sight_camera;
    row.segment<3>(at.pose) += about.cross(sight_target);
    row.segment<3>(at.pose + 3) += sight_target;
    const double x = 2 * s.uv.x() / scene.print.columns - 1;
    const double y = 2 * s.uv.y() / scene.print.rows - 1;
    row.segment<3>(at.bend) += d.sight.z() * Eigen::Vector3d(x * x, x * y, y * y);
    row.head(at.rest) *= d.gain;
    row.segment(at.rest, errors.size()) = d.basis;
    row.head(at.count) *= scale / sigma;
    row[at.count] = scale * miss;
    ++rows;
  }
  return sum.sum();
}

std::vector<DepthSample> depth_samples(const BoardPrint& print, const Pictures& pictures,
                                       const RigModel& model, std::size_t camera,
                                       const std::vector<int>& views) {
  const int patch_px = std::max(4, model.cameras[camera].size_px.width / 50);
  std::vector<DepthSample> out;
  for (const int view : views) {
    const ViewPictures& seen = pictures[view][camera];
    const Scene scene = make_scene(model, print, camera, view);
    const Size size = scene.camera.size_px;
    std::map<std::array<int, 3>, DepthSample> patches;
    for (const Sample& s : render(scene, pixels_on_board(scene), true)) {
      const double depth_m = seen.depth_m.at(s.x, s.y);
      if (depth_m <= 0) continue;
      // Separately by colour; a far board has hardly a pixel without an edge.
      const int color = s.ink < 0.25 ? 0 : s.ink > 0.75 ? 2 : 1;
      DepthSample& patch = patches[{s.y / patch_px, s.x / patch_px, color}];
      const BoardPoint point = board_point(model, print.columns, print.rows, s.uv);
      const double board = (point.p_m - scene.eye).norm();
      const double measured = along_ray(scene, seen, depth_m, point.p_m);
      if (std::abs(measured - board) > 0.3) continue;
      patch.view = view;
      patch.measured_m += measured, patch.board_m += board;
      patch.amplitude += seen.picture.at(s.x, s.y);
      patch.place +=
          Eigen::Vector2d(2.0 * s.x / (size.width - 1) - 1, 2.0 * s.y / (size.height - 1) - 1);
      patch.weight += 1;
    }
    for (auto& [key, patch] : patches) {
      if (patch.weight < 4) continue;
      patch.measured_m /= patch.weight, patch.board_m /= patch.weight;
      patch.amplitude /= patch.weight, patch.place /= patch.weight;
      out.push_back(patch);
    }
  }
  return out;
}

}  // namespace mixrig::calibration
