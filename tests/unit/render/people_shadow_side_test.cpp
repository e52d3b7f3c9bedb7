// SPDX-License-Identifier: Apache-2.0
// Shadows of a body by formula, whose front alone is seen, for lamps all around it.
#include <cmath>
#include <optional>

#include "host/render/cpu/light/people_shadow.h"
#include "host/render/cpu/light/visibility.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using Eigen::Vector3d;
constexpr double kAway_m = 2.5;  ///< the body's axis, before the camera

/// Elliptic cylinders along y (down), and a ball as head; camera axes.
struct UprightPart {
  double x_m, half_x_m, half_z_m, top_m, foot_m;
};
constexpr UprightPart kBody[] = {{0, 0.18, 0.11, -0.6, 0.1},
                                 {-0.1, 0.075, 0.075, 0.1, 0.9},
                                 {0.1, 0.075, 0.075, 0.1, 0.9},
                                 {-0.23, 0.045, 0.045, -0.58, 0.15},
                                 {0.23, 0.045, 0.045, -0.58, 0.15}};

/// Smallest t in (0, 1) at which from + t along meets the body; nullopt if none.
std::optional<double> meets(const Vector3d& from, const Vector3d& along) {
  std::optional<double> first;
  const auto take = [&](double t) {
    if (t > 0 && t < 1 && (!first || t < *first)) first = t;
  };
  const auto roots = [](double a, double b, double c) {
    const double root = b * b - a * c;
    return root < 0 ? std::optional<std::pair<double, double>>()
                    : std::pair{(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
  };
  for (const UprightPart& part : kBody) {
    const double x = (from.x() - part.x_m) / part.half_x_m, dx = along.x() / part.half_x_m;
    const double z = (from.z() - kAway_m) / part.half_z_m, dz = along.z() / part.half_z_m;
    const auto sides = roots(dx * dx + dz * dz, x * dx + z * dz, x * x + z * z - 1);
    if (!sides) continue;
    double begin = sides->first, end = sides->second;
    if (along.y() != 0) {
      const double t0 = (part.top_m - from.y()) / along.y(),
                   t1 = (part.foot_m - from.y()) / along.y();
      begin = std::max(begin, std::min(t0, t1)), end = std::min(end, std::max(t0, t1));
    } else if (from.y() < part.top_m || from.y() > part.foot_m) {
      continue;
    }
    if (begin < end) take(begin);
  }
  const Vector3d head = from - Vector3d(0, -0.74, kAway_m);
  if (const auto t = roots(along.squaredNorm(), along.dot(head), head.squaredNorm() - 0.0121))
    take(t->first);
  return first;
}

struct Shares {
  double found = 0, wrong = 0;  ///< of the true shadow's area
};

/// Shares of the shadow on a plane 1 m behind the body as the lamp sees it. Azimuth 0: the lamp is
/// above the camera.
Shares shares_of_shadow(double azimuth_rad) {
  render::CompositorSetup setup = plain_setup({320, 240}, 320, {64, 48}, 64);
  setup.capture_box = render::CaptureBox{{-2.5, -2, 0.5}, {2.5, 2, 5}};
  setup.people_cast_shadows = true;
  const Vector3d outwards(std::sin(azimuth_rad), 0, -std::cos(azimuth_rad));
  geometry::Lamp lamp;
  lamp.position_m = Vector3d(0, -1.3, kAway_m) + 2 * outwards;
  setup.light.lamps.push_back(lamp);
  const std::vector<glm::vec3> corners{{-9, -9, 8}, {9, -9, 8}, {9, 9, 8}}, normals(3, {0, 0, -1});
  const std::vector<std::uint32_t> triangles{0, 2, 1};
  render::VirtualObject wall;
  wall.meshes.push_back({corners, normals, {}, triangles, glm::vec3(1), {}, true});
  wall.casts_shadow = false;
  setup.objects.push_back(wall);
  Image<float> w({323, 243}, 0);
  Image<std::uint8_t> matte({320, 240}, 0);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x)
      if (const auto t =
              meets(Vector3d::Zero(), 8 * Vector3d((x - 159.5) / 320, (y - 119.5) / 320, 1)))
        w.at(x, y) = static_cast<float>(1 / (8 * *t)), matte.at(x, y) = 255;
  render::FramePreparer preparer(setup);
  preparer.update({});
  render::cpu::PeopleShadow people({320, 240});
  Crew crew(1);
  render::cpu::draw_people_maps(crew, preparer.params(),
                                {glm::vec2(320), glm::vec2(159.5F, 119.5F)}, w, matte, people);
  const Vector3d across(outwards.z(), 0, -outwards.x());
  double truth = 0, found = 0, wrong = 0;
  for (double u = -0.8; u < 0.8; u += 0.02)
    for (double y = -0.9; y < 1.7; y += 0.02) {
      const Vector3d p = Vector3d(0, y, kAway_m) - outwards + u * across;
      const bool is = meets(p, lamp.position_m - p).has_value();
      render::cpu::VectorLanes q{}, n{};
      q.x += static_cast<float>(p.x()), q.y += static_cast<float>(p.y());
      q.z += static_cast<float>(p.z());
      n.x += static_cast<float>(outwards.x()), n.z += static_cast<float>(outwards.z());
      const bool told = render::cpu::visibility(people.lamps[0], people.maps[0], q, n)[0] < 0.5F;
      truth += is, found += is && told, wrong += !is && told;
    }
  return {found / truth, wrong / truth};
}

TEST(PeopleShadowSide, MostOfTheShadowIsFoundWhereverTheLampStands) {
  for (const int degrees : {0, 45, 90, 135, 180}) {
    const Shares shares = shares_of_shadow(degrees * 0.017453);
    EXPECT_GT(shares.found, 0.9) << degrees;
    EXPECT_LT(shares.wrong, 0.25) << degrees;
  }
}

}  // namespace
}  // namespace mixrig::test
