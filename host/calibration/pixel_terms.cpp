// SPDX-License-Identifier: Apache-2.0
// What every pixel of a view tells about a rig: analysis by synthesis (paper A, section 4.1).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "host/calibration/rig_terms.h"
#include "host/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

constexpr double kHuber = 3;    // sigmas
constexpr double kEdge = 0.12;  // squares at the board's rim that are left out
constexpr int kRayStep_px = 4;  // rays are linear in between, then corrected where it matters
constexpr int kLight = 6;       // terms of the light over the board, apart for ink and paper
constexpr double kSquareVar = 1.0 / 12;  // variance of a pixel's own square
constexpr double kLeastShare = 0.85;     // of the variance that a picture of the board explains
constexpr long kLeastPixels = 200;

using Light = Eigen::Matrix<double, 2 * kLight, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// One view of one camera, ready for rendering.
struct Scene {
  const RigModel& model;
  const RigCamera& camera;
  const BoardPrint& print;
  geometry::Pose target_from_board, camera_from_board;
  Eigen::Matrix3d r, board_from_camera;  ///< camera_from_board's rotation and its inverse
  Eigen::Vector3d eye;                   ///< the camera in board axes
};

/// A pixel on the board.
struct Sample {
  int x = 0, y = 0;
  Eigen::Vector2d uv;
  double ink = 0, ink_by_blur = 0;
  bool edge = false;             ///< where the colour changes: only these tell about geometry
  Eigen::RowVector2d ink_by_px;  ///< how ink changes with the place in the picture
  Vector6 light;                 ///< 1, x, y, x^2, x y, y^2 on the board, times falloff
};

Scene make_scene(const RigModel& model, const BoardPrint& print, std::size_t camera, int view) {
  const RigCamera& c = model.cameras[camera];
  const geometry::Pose pose = c.camera_from_target * model.target_from_board[view];
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  return {model, c, print,         model.target_from_board[view],
          pose,  r, r.transpose(), -(r.transpose() * pose.translation_m)};
}

/// Rays of a grid of pixels inside a rectangle, linear in between.
class Rays {
 public:
  Rays(const RigCamera& camera, int x0, int y0, int x1, int y1)
      : x0_(x0), y0_(y0), columns_((x1 - x0) / kRayStep_px + 2) {
    const auto lens = geometry::make_camera(camera.lens, camera.size_px, camera.parameters);
    const int rows = (y1 - y0) / kRayStep_px + 2;
    rays_.resize(static_cast<std::size_t>(columns_) * rows, Eigen::Vector3d::Zero());
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns_; ++i) {
        const auto ray = geometry::unproject(lens, {x0 + kRayStep_px * static_cast<double>(i),
                                                    y0 + kRayStep_px * static_cast<double>(j)});
        if (!ray) continue;
        const bool pinhole = camera.lens == geometry::LensKind::kPinhole;
        rays_[static_cast<std::size_t>(j) * columns_ + i] = pinhole ? *ray / ray->z() : *ray;
      }
  }
  /// Zero where the lens has none.
  Eigen::Vector3d at(int x, int y) const {
    const int i = (x - x0_) / kRayStep_px, j = (y - y0_) / kRayStep_px;
    const double s = static_cast<double>((x - x0_) % kRayStep_px) / kRayStep_px;
    const double t = static_cast<double>((y - y0_) % kRayStep_px) / kRayStep_px;
    const Eigen::Vector3d* top = &rays_[static_cast<std::size_t>(j) * columns_ + i];
    const Eigen::Vector3d* below = top + columns_;
    if (top[0].isZero() || top[1].isZero() || below[0].isZero() || below[1].isZero())
      return Eigen::Vector3d::Zero();
    return (1 - t) * ((1 - s) * top[0] + s * top[1]) + t * ((1 - s) * below[0] + s * below[1]);
  }

 private:
  int x0_, y0_, columns_;
  std::vector<Eigen::Vector3d> rays_;
};

/// Where a ray meets the board, in squares; false where it does not.
bool meet(const Scene& scene, const Eigen::Vector3d& ray, Eigen::Vector2d& uv) {
  const Eigen::Vector3d d = scene.board_from_camera * ray;
  if (!(d.z() > 1e-9)) return false;  // the front is seen
  double w = 0;
  for (int i = 0; i < 3; ++i) {
    const double t = (w - scene.eye.z()) / d.z();
    if (!(t > 0)) return false;
    const Eigen::Vector3d p = scene.eye + t * d;
    uv = p.head<2>() / scene.model.square_m;
    if (scene.model.bend.isZero()) break;
    w = board_point(scene.model, scene.print.columns, scene.print.rows, uv).p_m.z();
  }
  return uv.x() > kEdge && uv.y() > kEdge && uv.x() < scene.print.columns - kEdge &&
         uv.y() < scene.print.rows - kEdge;
}

struct Box {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
};

/// Pixels that the board may cover.
Box covered(const Scene& scene) {
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  const BoardPrint& p = scene.print;
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i)
    for (const auto& [a, b] :
         {std::pair(i, 0), std::pair(i, kSteps), std::pair(0, i), std::pair(kSteps, i)}) {
      const Eigen::Vector2d uv(p.columns * a / double{kSteps}, p.rows * b / double{kSteps});
      const Eigen::Vector3d at =
          scene.camera_from_board * board_point(scene.model, p.columns, p.rows, uv).p_m;
      const auto seen =
          geometry::project_with_jacobians(scene.camera.lens, scene.camera.parameters.data(), at);
      if (!seen) return {};
      low = low.cwiseMin(seen->px), high = high.cwiseMax(seen->px);
    }
  const Size size = scene.camera.size_px;
  if (!(low.x() < size.width && low.y() < size.height && high.x() >= 0 && high.y() >= 0)) return {};
  return {std::max(0, static_cast<int>(low.x()) - 1), std::max(0, static_cast<int>(low.y()) - 1),
          std::min(size.width - 1, static_cast<int>(high.x()) + 2),
          std::min(size.height - 1, static_cast<int>(high.y()) + 2)};
}

/// Projection of a board point, with the picture's change over the board.
struct Foot {
  geometry::Projection seen;
  Eigen::Vector3d in_target;  ///< the point
  Eigen::Matrix2d px_by_uv;
};

bool foot_of(const Scene& scene, const Eigen::Vector2d& uv, Foot& foot) {
  const BoardPoint point = board_point(scene.model, scene.print.columns, scene.print.rows, uv);
  foot.in_target = scene.target_from_board * point.p_m;
  const auto seen = geometry::project_with_jacobians(
      scene.camera.lens, scene.camera.parameters.data(), scene.camera_from_board * point.p_m);
  if (!seen) return false;
  foot.seen = *seen;
  foot.px_by_uv = seen->d_point * scene.r * point.d_uv;
  return true;
}

/// Ink under a pixel at an edge; moves uv to the pixel's exact place.
bool render_edge(const Scene& scene, Sample& s) {
  Foot foot;
  if (!foot_of(scene, s.uv, foot)) return false;
  const Eigen::Matrix2d uv_by_px = foot.px_by_uv.inverse();
  s.uv += uv_by_px * (Eigen::Vector2d(s.x, s.y) - foot.seen.px);
  const Eigen::Matrix2d shape = uv_by_px * uv_by_px.transpose();
  const double blur = scene.camera.blur_px, variance = blur * blur + kSquareVar;
  const InkShare share = ink_under(scene.print, s.uv, variance * shape);
  constexpr double kMore = 1.02;
  const InkShare wider = ink_under(scene.print, s.uv, kMore * variance * shape);
  s.ink = share.ink;
  s.ink_by_blur = (wider.ink - share.ink) / ((kMore - 1) * variance) * 2 * blur;
  s.ink_by_px = share.d_uv.transpose() * uv_by_px;
  return true;
}

/// All pixels on the board. The light of a depth camera comes from beside its lens: it falls off
/// with the square of the distance and with the cosine.
std::vector<Sample> render(const Scene& scene, bool own_light) {
  std::vector<Sample> samples;
  const Box box = covered(scene);
  if (box.x1 < box.x0 || box.y1 < box.y0) return samples;
  const Rays rays(scene.camera, box.x0, box.y0, box.x1, box.y1);
  const double reach_px = 4.5 * std::sqrt(scene.camera.blur_px * scene.camera.blur_px + kSquareVar);
  for (int y = box.y0; y <= box.y1; ++y) {
    Eigen::Vector2d before(0, 0), above(0, 0);
    bool has_before = false;
    for (int x = box.x0; x <= box.x1; ++x) {
      const Eigen::Vector3d ray = rays.at(x, y);
      Sample s;
      s.x = x, s.y = y;
      if (ray.isZero() || !meet(scene, ray, s.uv)) {
        has_before = false;
        continue;
      }
      if (!has_before && !meet(scene, rays.at(std::max(x - 1, box.x0), y), before)) before = s.uv;
      if (!meet(scene, rays.at(x, std::max(y - 1, box.y0)), above)) above = s.uv;
      const Eigen::Vector2d reach =
          reach_px * ((s.uv - before).cwiseAbs() + (s.uv - above).cwiseAbs()).cwiseMax(1e-4);
      before = s.uv, has_before = true;
      s.edge = !is_plain(scene.print, s.uv, reach, s.ink);
      if (s.edge && !render_edge(scene, s)) continue;
      const double a = 2 * s.uv.x() / scene.print.columns - 1;
      const double b = 2 * s.uv.y() / scene.print.rows - 1;
      s.light << 1, a, b, a * a, a * b, b * b;
      if (own_light) {
        const Eigen::Vector3d p =
            board_point(scene.model, scene.print.columns, scene.print.rows, s.uv).p_m - scene.eye;
        const double d = p.norm();
        s.light *= std::abs(p.z()) / (d * d * d);
      }
      samples.push_back(s);
    }
  }
  return samples;
}

/// Best light on ink and paper for rendered samples, twice: the second time with outliers weighed
/// down. `sigma`: root mean square of what is left; `share`: of the variance that is explained.
Light solve_light(const std::vector<Sample>& samples, const Image<float>& picture, double& sigma,
                  double& share) {
  Light light = Light::Zero();
  sigma = 0, share = 0;
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix<double, 2 * kLight, 2 * kLight> h;
    h.setZero();
    Light g = Light::Zero();
    double sum = 0, squares = 0, misses = 0;
    for (const Sample& s : samples) {
      Light row;
      row << (1 - s.ink) * s.light, s.ink * s.light;
      const double value = picture.at(s.x, s.y), miss = value - row.dot(light);
      const double weight =
          round > 0 && std::abs(miss) > kHuber * sigma ? kHuber * sigma / std::abs(miss) : 1;
      h.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      g += weight * value * row;
      sum += value, squares += value * value;
    }
    h.diagonal().array() += 1e-9 * h.trace() / (2 * kLight);
    light = Eigen::Matrix<double, 2 * kLight, 2 * kLight>(h.selfadjointView<Eigen::Lower>())
                .ldlt()
                .solve(g);
    for (const Sample& s : samples) {
      const double miss = picture.at(s.x, s.y) - (1 - s.ink) * s.light.dot(light.head<kLight>()) -
                          s.ink * s.light.dot(light.tail<kLight>());
      misses += miss * miss;
    }
    const auto n = static_cast<double>(samples.size());
    sigma = std::sqrt(misses / n);
    share = 1 - misses / std::max(squares - sum * sum / n, 1e-30);
  }
  return light;
}

/// Columns of one camera's own sum: [free intrinsics, six of camera_from_target, blur, six of the
/// view, three of the bend, light or depth knots].
struct Local {
  int free, extrinsics, blur, pose, bend, rest, count;
};
Local local_of(const RigCamera& camera, int rest) {
  Local l{};
  l.free = static_cast<int>(camera.free.size());
  l.extrinsics = l.free, l.blur = l.extrinsics + 6, l.pose = l.blur + 1, l.bend = l.pose + 6;
  l.rest = l.bend + 3, l.count = l.rest + rest;
  return l;
}

/// Adds `by_px` times how the pixel of a fixed board point moves with every parameter.
template <typename Row>
void add_motion(const Scene& scene, const Foot& foot, const Eigen::Vector2d& uv,
                const Eigen::RowVector2d& by_px, const Local& at, Row&& row) {
  for (int i = 0; i < at.free; ++i)
    row[i] += by_px.dot(foot.seen.d_parameters.col(scene.camera.free[i]));
  const Eigen::RowVector3d by_point = by_px * foot.seen.d_point;
  const Eigen::Vector3d turned = scene.camera.camera_from_target.rotation * foot.in_target;
  const Eigen::RowVector3d by_target =
      by_point * scene.camera.camera_from_target.rotation.toRotationMatrix();
  row.template segment<3>(at.extrinsics) -= (by_point * estimation::skew(turned)).transpose();
  row.template segment<3>(at.extrinsics + 3) += by_point.transpose();
  const Eigen::Vector3d about = foot.in_target - scene.target_from_board.translation_m;
  row.template segment<3>(at.pose) -= (by_target * estimation::skew(about)).transpose();
  row.template segment<3>(at.pose + 3) += by_target.transpose();
  const double x = 2 * uv.x() / scene.print.columns - 1, y = 2 * uv.y() / scene.print.rows - 1;
  const double out = by_target.dot(scene.target_from_board.rotation * Eigen::Vector3d::UnitZ());
  row.template segment<3>(at.bend) += out * Eigen::Vector3d(x * x, x * y, y * y);
}

/// Sums of the grey residuals of a picture, light eliminated.
Eigen::MatrixXd grey_sums(const Scene& scene, const std::vector<Sample>& samples,
                          const Image<float>& picture, double weight_sigma, const Local& at) {
  double sigma = 0, share = 0;
  const Light light = solve_light(samples, picture, sigma, share);
  RowSum sum(at.count);
  Foot foot;
  for (const Sample& s : samples) {
    const double paper = s.light.dot(light.head<kLight>());
    const double ink = s.light.dot(light.tail<kLight>());
    const double miss = (paper + s.ink * (ink - paper) - picture.at(s.x, s.y)) / weight_sigma;
    const double scale = (std::abs(miss) > kHuber ? std::sqrt(kHuber / std::abs(miss)) : 1);
    auto row = sum.next();
    if (s.edge && foot_of(scene, s.uv, foot)) {
      // At a fixed pixel the picture slides the other way.
      add_motion(scene, foot, s.uv, -(ink - paper) * s.ink_by_px, at, row);
      row[at.blur] = (ink - paper) * s.ink_by_blur;
    }
    row.segment<kLight>(at.rest) = (1 - s.ink) * s.light;
    row.segment<kLight>(at.rest + kLight) = s.ink * s.light;
    row.head(at.count) *= scale / weight_sigma;
    row[at.count] = scale * miss;
  }
  const Eigen::MatrixXd& all = sum.sum();
  // Light is linear: its best values for any step of the rest.
  const int keep = at.rest, total = at.count + 1;
  Eigen::MatrixXd cross(total - 2 * kLight, 2 * kLight), h(total - 2 * kLight, total - 2 * kLight);
  cross.topRows(keep) = all.block(0, keep, keep, 2 * kLight);
  cross.bottomRows(1) = all.block(at.count, keep, 1, 2 * kLight);
  h.topLeftCorner(keep, keep) = all.topLeftCorner(keep, keep);
  h.topRightCorner(keep, 1) = all.block(0, at.count, keep, 1);
  h.bottomLeftCorner(1, keep) = all.block(at.count, 0, 1, keep);
  h(keep, keep) = all(at.count, at.count);
  Eigen::MatrixXd own = all.block(keep, keep, 2 * kLight, 2 * kLight);
  own.diagonal().array() += 1e-9 * own.trace() / (2 * kLight);
  return h - cross * own.ldlt().solve(cross.transpose());
}

/// Spline basis by measured distance, tabulated.
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
  auto at(double distance_m) const {
    const double place =
        std::clamp((distance_m - first_) / kStep, 0.0, static_cast<double>(table_.cols()) - 1.001);
    const auto i = static_cast<Eigen::Index>(place);
    const double s = place - static_cast<double>(i);
    return (1 - s) * table_.col(i) + s * table_.col(i + 1);
  }

 private:
  static constexpr double kStep = 0.005;
  double first_;
  Eigen::MatrixXd table_;
};

/// Depth residual of a sample: board + curve - measured.
struct DepthMiss {
  double miss_m = 0, distance_m = 0;
  Eigen::Vector3d sight;  ///< unit, camera to point, board axes
};

bool depth_miss(const Scene& scene, const Basis& basis, const Eigen::VectorXd& error_m,
                const Sample& s, const Image<float>& measured, DepthMiss& out) {
  out.distance_m = measured.at(s.x, s.y);
  if (out.distance_m <= 0) return false;
  const Eigen::Vector3d way =
      board_point(scene.model, scene.print.columns, scene.print.rows, s.uv).p_m - scene.eye;
  const double distance = way.norm();
  out.sight = way / distance;
  out.miss_m = distance + error_m.dot(basis.at(out.distance_m)) - out.distance_m;
  return std::abs(out.miss_m) < 0.15;
}

Eigen::VectorXd errors_of(const RigModel& model) {
  return Eigen::Map<const Eigen::VectorXd>(model.depth.error_m.data(),
                                           static_cast<Eigen::Index>(model.depth.error_m.size()));
}

Eigen::MatrixXd depth_sums(const Scene& scene, const std::vector<Sample>& samples,
                           const Image<float>& measured, const PixelTerms::Weights& weights,
                           const Local& at, long& rows) {
  const Basis basis(scene.model.depth.knots_m);
  const Eigen::VectorXd errors = errors_of(scene.model);
  RowSum sum(at.count);
  Foot foot;
  DepthMiss d;
  for (const Sample& s : samples) {
    if (!depth_miss(scene, basis, errors, s, measured, d) || !foot_of(scene, s.uv, foot)) continue;
    const double sigma = weights.paper_m + s.ink * (weights.ink_m - weights.paper_m);
    const double miss = d.miss_m / sigma;
    const double scale = std::abs(miss) > kHuber ? std::sqrt(kHuber / std::abs(miss)) : 1;
    auto row = sum.next();
    const BoardPoint point = board_point(scene.model, scene.print.columns, scene.print.rows, s.uv);
    // The ray of the pixel stays: the board's point under it slides as the board moves.
    const Eigen::RowVector2d by_uv = d.sight.transpose() * point.d_uv;
    add_motion(scene, foot, s.uv, -by_uv * foot.px_by_uv.inverse(), at, row);
    // and the point itself moves along the ray.
    const Eigen::Vector3d sight_target = scene.target_from_board.rotation * d.sight;
    const Eigen::Vector3d sight_camera = scene.r * d.sight;
    const Eigen::Vector3d turned = scene.camera.camera_from_target.rotation * foot.in_target;
    const Eigen::Vector3d about = foot.in_target - scene.target_from_board.translation_m;
    row.segment<3>(at.extrinsics) += turned.cross(sight_camera);
    row.segment<3>(at.extrinsics + 3) += sight_camera;
    row.segment<3>(at.pose) += about.cross(sight_target);
    row.segment<3>(at.pose + 3) += sight_target;
    const double x = 2 * s.uv.x() / scene.print.columns - 1;
    const double y = 2 * s.uv.y() / scene.print.rows - 1;
    row.segment<3>(at.bend) += d.sight.z() * Eigen::Vector3d(x * x, x * y, y * y);
    row.segment(at.rest, errors.size()) = basis.at(d.distance_m);
    row.head(at.count) *= scale / sigma;
    row[at.count] = scale * miss;
    ++rows;
  }
  return sum.sum();
}

/// Adds a camera's own sums to those of the view.
void scatter(const Eigen::MatrixXd& own, const Local& at, const RigLayout& layout,
             std::size_t camera, bool depth, Eigen::MatrixXd& sum) {
  const RigLayout::Camera& place = layout.cameras[camera];
  std::vector<int> to(static_cast<std::size_t>(own.rows()), -1);
  const auto map = [&](int from, int where, int count) {
    for (int i = 0; i < count && where >= 0; ++i) to[from + i] = where + i;
  };
  map(0, place.intrinsics, at.free);
  map(at.extrinsics, place.extrinsics, 6);
  map(at.blur, place.blur, 1);
  map(at.pose, layout.count, 6);
  map(at.bend, layout.bend, 3);
  if (depth) map(at.rest, layout.depth, at.count - at.rest);
  to.back() = layout.count + 6;
  for (Eigen::Index i = 0; i < own.rows(); ++i)
    for (Eigen::Index j = 0; j < own.cols(); ++j)
      if (to[i] >= 0 && to[j] >= 0) sum(to[i], to[j]) += own(i, j);
}

/// Sigma of depth on one colour, robust: 1.4826 times the median of absolute differences.
double scatter_m(std::vector<double>& misses) {
  if (misses.size() < 20) return 0.01;
  const auto middle = misses.begin() + static_cast<std::ptrdiff_t>(misses.size() / 2);
  std::nth_element(misses.begin(), middle, misses.end());
  const double median = *middle;
  for (double& m : misses) m = std::abs(m - median);
  std::nth_element(misses.begin(), middle, misses.end());
  return std::max(1.4826 * *middle, 2e-4);
}

}  // namespace

void PixelTerms::weigh(const RigModel& model, const std::vector<int>& views, Crew& crew) {
  const std::size_t cameras = model.cameras.size();
  weights_.assign(pictures_.size(), std::vector<Weights>(cameras));
  crew.rows(static_cast<int>(views.size() * cameras), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int view = views[i / cameras];
      const std::size_t c = i % cameras;
      const ViewPictures& seen = pictures_[view][c];
      Weights& w = weights_[view][c];
      if (seen.picture.empty()) continue;
      const Scene scene = make_scene(model, print_, c, view);
      const auto samples = render(scene, !seen.distance_m.empty());
      if (static_cast<long>(samples.size()) < kLeastPixels) continue;
      double share = 0;
      const Light light = solve_light(samples, seen.picture, w.grey, share);
      w.pixels = static_cast<long>(samples.size());
      w.contrast = std::abs(
          samples[samples.size() / 2].light.dot(light.head<kLight>() - light.tail<kLight>()));
      w.used = share > kLeastShare;
      if (seen.distance_m.empty() || model.depth.knots_m.size() < 2) continue;
      const Basis basis(model.depth.knots_m);
      std::vector<double> paper, ink;
      DepthMiss d;
      for (const Sample& s : samples)
        if (depth_miss(scene, basis, errors_of(model), s, seen.distance_m, d))
          (s.ink < 0.5 ? paper : ink).push_back(d.miss_m);
      w.paper_m = scatter_m(paper), w.ink_m = scatter_m(ink);
    }
  });
}

ViewTerm PixelTerms::sums(const RigModel& model, const RigLayout& layout, int view) const {
  ViewTerm term;
  term.sum = Eigen::MatrixXd::Zero(layout.count + 7, layout.count + 7);
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    const Weights& w = weights_[view][c];
    if (!w.used) continue;
    const ViewPictures& seen = pictures_[view][c];
    const Scene scene = make_scene(model, print_, c, view);
    const auto samples = render(scene, !seen.distance_m.empty());
    if (static_cast<long>(samples.size()) < kLeastPixels) continue;
    const Local at = local_of(scene.camera, 2 * kLight);
    // The sum without light has its residual where light began.
    scatter(grey_sums(scene, samples, seen.picture, w.grey, at), at, layout, c, false, term.sum);
    term.rows += static_cast<long>(samples.size());
    if (seen.distance_m.empty() || layout.depth < 0) continue;
    const Local deep = local_of(scene.camera, static_cast<int>(model.depth.knots_m.size()));
    scatter(depth_sums(scene, samples, seen.distance_m, w, deep, term.rows), deep, layout, c, true,
            term.sum);
  }
  return term;
}

ViewFunction PixelTerms::function() const {
  return [this](const RigModel& model, const RigLayout& layout, int view) {
    return sums(model, layout, view);
  };
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
    for (const Sample& s : render(scene, true)) {
      const double measured = seen.distance_m.at(s.x, s.y);
      if (measured <= 0) continue;
      // Apart by colour; far boards show hardly a pixel without an edge.
      const int color = s.ink < 0.25 ? 0 : s.ink > 0.75 ? 2 : 1;
      DepthSample& patch = patches[{s.y / patch_px, s.x / patch_px, color}];
      const BoardPoint point = board_point(model, print.columns, print.rows, s.uv);
      const double board = (point.p_m - scene.eye).norm();
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

double PixelTerms::grey_rms(int camera) const {
  double squares = 0, pixels = 0;
  for (const auto& view : weights_) {
    const Weights& w = view[static_cast<std::size_t>(camera)];
    if (!w.used) continue;
    const auto n = static_cast<double>(w.pixels);
    squares += n * std::pow(w.grey / w.contrast, 2), pixels += n;
  }
  return pixels > 0 ? std::sqrt(squares / pixels) : 0;
}

double PixelTerms::depth_rms_m() const {
  double squares = 0, pixels = 0;
  for (const auto& view : weights_)
    for (const Weights& w : view)
      if (w.used && w.paper_m > 0)
        squares += static_cast<double>(w.pixels) * w.paper_m * w.paper_m,
            pixels += static_cast<double>(w.pixels);
  return pixels > 0 ? std::sqrt(squares / pixels) : 0;
}

}  // namespace mixrig::calibration
