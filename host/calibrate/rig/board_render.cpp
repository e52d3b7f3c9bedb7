// SPDX-License-Identifier: Apache-2.0
// The board as one camera sees it in one view.
#include "host/calibrate/rig/board_render.h"

#include <cmath>

#include <Eigen/LU>

namespace mixrig::calibration {
namespace {

constexpr double kEdge = 0.12;  // squares at the board's border that are left out
constexpr int kRayStep_px = 4;  // rays are linear in between, then corrected where it matters
constexpr double kSquareVar = 1.0 / 12;  // variance of a pixel's own square

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

/// Intersects a ray with the board, in squares; false where it does not meet the front.
bool meet(const Scene& scene, const Eigen::Vector3d& ray, Eigen::Vector2d& uv) {
  const Eigen::Vector3d d = scene.board_from_camera * ray;
  if (!(d.z() > 1e-9)) return false;  // only the front is visible
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

/// Ink under a pixel at an edge; moves uv to the pixel's exact place.
bool render_edge(const Scene& scene, Sample& s) {
  ProjectedBoardPoint projected;
  if (!project_board_point(scene, s.uv, projected)) return false;
  const Eigen::Matrix2d uv_by_px = projected.px_by_uv.inverse();
  s.uv += uv_by_px * (Eigen::Vector2d(s.x, s.y) - projected.seen.px);
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

}  // namespace

Scene make_scene(const RigModel& model, const BoardPrint& print, std::size_t camera, int view) {
  const RigCamera& c = model.cameras[camera];
  const geometry::Pose pose = c.camera_from_target * model.target_from_board[view];
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  return {model, c, print,         model.target_from_board[view],
          pose,  r, r.transpose(), -(r.transpose() * pose.translation_m)};
}

bool project_board_point(const Scene& scene, const Eigen::Vector2d& uv,
                         ProjectedBoardPoint& projected) {
  const BoardPoint point = board_point(scene.model, scene.print.columns, scene.print.rows, uv);
  projected.in_target = scene.target_from_board * point.p_m;
  const auto seen = geometry::project_with_jacobians(
      scene.camera.lens, scene.camera.parameters.data(), scene.camera_from_board * point.p_m);
  if (!seen) return false;
  projected.seen = *seen;
  projected.px_by_uv = seen->d_point * scene.r * point.d_uv;
  return true;
}

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

}  // namespace mixrig::calibration
