// SPDX-License-Identifier: Apache-2.0
// A box with panels on its ceiling, a mirror, balls and a table, drawn by formula as fisheye
// pictures and as a panorama.
#pragma once

#include <algorithm>
#include <vector>

#include "hal/base/angles.h"
#include "host/room/lamps/lamp_tracks.h"
#include "tests/unit/lamps/drawn_fisheye.h"

namespace mixrig::test {

struct DrawnBox {
  struct Panel {
    Eigen::Vector3d middle_m;
    double intensity = 1;
  };
  Eigen::Vector3d size_m{5, 4, 2.9};
  std::vector<Panel> lamps{{{1.8, 1.0, 2.9}, 2}, {{3.6, 2.8, 2.9}, 4}};
  Eigen::Vector2d panel_m{0.5, 0.3};
  bool mirror = false;       ///< on the wall x = 5: y 1 to 3, z 0.8 to 2.75
  bool ball = false;         ///< polished, radius 0.25 at (3, 1, 0.9)
  bool white_ball = false;   ///< radius 0.35 at (3, 1, 1.9), saturated where it faces up
  bool white_table = false;  ///< 0.8 x 0.6 m at (3, 1.6, 0.75)
  DrawnFisheye lens{};

  struct Hit {
    double t = 1e9;
    Eigen::Vector3d normal;
  };
  Hit walls(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) const {
    Hit hit;
    for (int i = 0; i < 3; ++i) {
      if (std::abs(ray[i]) < 1e-12) continue;
      const double t = ((ray[i] > 0 ? size_m[i] : 0) - eye[i]) / ray[i];
      if (t > 1e-9 && t < hit.t) hit = {t, (ray[i] > 0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(i)};
    }
    return hit;
  }
  static double ball_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray,
                        const Eigen::Vector3d& middle, double radius) {
    const Eigen::Vector3d to = middle - eye;
    const double along = to.dot(ray), off2 = to.squaredNorm() - along * along;
    if (off2 > radius * radius || along < 0) return 1e9;
    return along - std::sqrt(radius * radius - off2);
  }
  bool on_panel(const Eigen::Vector3d& p) const {
    return p.z() > size_m.z() - 1e-6 &&
           std::any_of(lamps.begin(), lamps.end(), [&](const Panel& lamp) {
             return std::abs(p.x() - lamp.middle_m.x()) < 0.5 * panel_m.x() &&
                    std::abs(p.y() - lamp.middle_m.y()) < 0.5 * panel_m.y();
           });
  }
  Eigen::Vector3d table_low_m() const { return {2.6, 1.3, 0.75}; }
  bool on_table(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray, double& t) const {
    if (!white_table || ray.z() >= 0) return false;
    t = (table_low_m().z() - eye.z()) / ray.z();
    const Eigen::Vector3d p = eye + t * ray - table_low_m();
    return t > 0 && p.x() > 0 && p.x() < 0.8 && p.y() > 0 && p.y() < 0.6;
  }

  double grey(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray, int bounces = 2) const {
    double table = 0;
    if (on_table(eye, ray, table)) return 255;
    const Eigen::Vector3d polished(3, 1, 0.9), white(3, 1, 1.9);
    if (ball && bounces > 0) {
      const double t = ball_at(eye, ray, polished, 0.25);
      if (t < 1e8) {
        const Eigen::Vector3d p = eye + t * ray, n = (p - polished).normalized();
        return 0.9 * grey(p + 1e-6 * n, ray - 2 * ray.dot(n) * n, 0) + 25;
      }
    }
    if (white_ball) {
      const double t = ball_at(eye, ray, white, 0.35);
      if (t < 1e8) return 180 + 110 * ((eye + t * ray - white) / 0.35).z();
    }
    const Hit hit = walls(eye, ray);
    const Eigen::Vector3d p = eye + hit.t * ray;
    if (mirror && bounces > 0 && p.x() > size_m.x() - 1e-6 && p.y() > 1 && p.y() < 3 &&
        p.z() > 0.8 && p.z() < 2.75)
      return grey(p + 1e-6 * hit.normal, {-ray.x(), ray.y(), ray.z()}, bounces - 1);
    return on_panel(p) ? 255 : 70;
  }

  lights::LampView view(const geometry::Pose& world_from_camera) const {
    const Image<Rgb8> picture = lens.draw([&](const Eigen::Vector3d& r) {
      return grey(world_from_camera.translation_m, world_from_camera.rotation * r);
    });
    return {world_from_camera, lights::find_bright_regions(picture, [&](const Eigen::Vector2d& px) {
              return lens.ray(px);
            })};
  }

  Eigen::Vector3d scan_m() const { return {2.1, 2.1, 1.45}; }
  /// A scan of the box without error; the mirror has the depth of its glass.
  model::Panorama panorama(int height = 240) const {
    model::Panorama p;
    const Size size{2 * height, height};
    p.distance_m.reset(size), p.sigma_m.reset(size, 0.003F), p.views.reset(size, 1);
    p.field.reset(size, 1), p.color.reset(size, {128, 128, 128});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < 2 * height; ++x) {
        const Eigen::Vector3d ray = model::direction_of(size, x, y);
        double t = walls(scan_m(), ray).t, table = 0;
        if (on_table(scan_m(), ray, table)) t = table;
        p.distance_m.at(x, y) = static_cast<float>(t);
      }
    return p;
  }
  lights::RoomSurfaces room() const {
    return {panorama(), {Eigen::Quaterniond::Identity(), scan_m()}};
  }
};

}  // namespace mixrig::test
