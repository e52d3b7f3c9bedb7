// SPDX-License-Identifier: Apache-2.0
// The board as one camera sees it in one view.
#include "host/calibrate/rig/board_render.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace mixrig::calibration {
namespace {

constexpr double kEdge = 0.12;  // squares at the board's border that are left out
constexpr int kRayStep_px = 4;  // rays are linear in between, then corrected where it matters
constexpr double kSquareVar = 1.0 / 12;  // variance of a pixel's own square

struct Box {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
};

/// Rays of a grid of pixels inside a rectangle, linear in between.
class Rays {
 public:
  Rays(const RigCamera& camera, const Box& box)
      : x0_(box.x0), y0_(box.y0), columns_((box.x1 - box.x0) / kRayStep_px + 2) {
    const auto lens = geometry::make_camera(camera.lens, camera.size_px, camera.parameters);
    const int rows = (box.y1 - box.y0) / kRayStep_px + 2;
    rays_.resize(static_cast<std::size_t>(columns_) * rows, Eigen::Vector3d::Zero());
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns_; ++i) {
        const auto ray = geometry::unproject(lens, {x0_ + kRayStep_px * static_cast<double>(i),
                                                    y0_ + kRayStep_px * static_cast<double>(j)});
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
  const bool flat = scene.model.bend.isZero();
  double w = 0;
  for (int i = 0; i < 3; ++i) {
    const double t = (w - scene.eye.z()) / d.z();
    if (!(t > 0)) return false;
    const Eigen::Vector3d p = scene.eye + t * d;
    uv = p.head<2>() / scene.model.square_m;
    if (flat) break;
    w = board_point(scene.model, scene.print.columns, scene.print.rows, uv).p_m.z();
  }
  return true;
}

bool is_on_board(const BoardPrint& print, const Eigen::Vector2d& uv) {
  return uv.x() > kEdge && uv.y() > kEdge && uv.x() < print.columns - kEdge &&
         uv.y() < print.rows - kEdge;
}

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

Box box_of(const std::vector<BoardPixel>& pixels) {
  Box box{pixels[0].x, pixels.front().y, pixels[0].x, pixels.back().y};
  for (const BoardPixel& p : pixels) box.x0 = std::min(box.x0, p.x), box.x1 = std::max(box.x1, p.x);
  return box;
}

/// Terms of the light at a place on the board.
LightRow light_at(const Scene& scene, const Eigen::Vector2d& uv, bool own_light) {
  const double a = 2 * uv.x() / scene.print.columns - 1, b = 2 * uv.y() / scene.print.rows - 1;
  LightRow light;
  light << 1, a, b, a * a, a * b, b * b;
  if (!own_light) return light;
  const Eigen::Vector3d p =
      board_point(scene.model, scene.print.columns, scene.print.rows, uv).p_m - scene.eye;
  const double d = p.norm();
  return light * (std::abs(p.z()) / (d * d * d));
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

std::vector<BoardPixel> pixels_on_board(const Scene& scene) {
  std::vector<BoardPixel> pixels;
  const Box box = covered(scene);
  if (box.x1 < box.x0 || box.y1 < box.y0) return pixels;
  const Rays rays(scene.camera, box);
  Eigen::Vector2d uv;
  for (int y = box.y0; y <= box.y1; ++y)
    for (int x = box.x0; x <= box.x1; ++x) {
      const Eigen::Vector3d ray = rays.at(x, y);
      if (!ray.isZero() && meet(scene, ray, uv) && is_on_board(scene.print, uv))
        pixels.push_back({x, y});
    }
  return pixels;
}

std::vector<Sample> render(const Scene& scene, const std::vector<BoardPixel>& pixels,
                           bool own_light) {
  std::vector<Sample> samples;
  if (pixels.empty()) return samples;
  const Box box = box_of(pixels);
  const Rays rays(scene.camera, box);
  const double reach_px = 4.5 * std::sqrt(scene.camera.blur_px * scene.camera.blur_px + kSquareVar);
  // The last place on the board in each column, and its row; column 0 lies left of the box.
  struct Place {
    int y = -1;
    Eigen::Vector2d uv;
  };
  std::vector<Place> places(static_cast<std::size_t>(box.x1 - box.x0 + 2));
  samples.reserve(pixels.size());
  for (const auto& [x, y] : pixels) {
    const Eigen::Vector3d ray = rays.at(x, y);
    Sample s;
    s.x = x, s.y = y;
    if (ray.isZero() || !meet(scene, ray, s.uv)) continue;
    Place* const place = &places[static_cast<std::size_t>(x - box.x0 + 1)];
    Eigen::Vector2d reach(0, 0);
    if (place[-1].y == y) reach += (s.uv - place[-1].uv).cwiseAbs();
    if (place->y == y - 1) reach += (s.uv - place->uv).cwiseAbs();
    reach = reach_px * reach.cwiseMax(1e-4);
    *place = {y, s.uv};
    s.edge = !is_plain(scene.print, s.uv, reach, s.ink);
    if (s.edge && !render_edge(scene, s)) continue;
    s.light = light_at(scene, s.uv, own_light);
    samples.push_back(s);
  }
  return samples;
}

}  // namespace mixrig::calibration
