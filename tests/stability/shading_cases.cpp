// SPDX-License-Identifier: Apache-2.0
#include "hal/base/srgb.h"
#include "host/room/lamps/shading.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"
#include "tests/unit/lamps/drawn_box.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using test::DrawnBox;

/// Parameters of a case; the defaults are a box whose walls have an albedo of their own each, 10 %
/// off from pixel to pixel, lit by two panels of strengths 2 and 4 and from all sides.
struct ShadedScene {
  double texture = 0.1;  ///< sigma of the albedo, a share
  double patch_m = 0;    ///< side of the cubes that have one albedo; 0: each pixel has its own
  double exposure = 0.7;
  double ambient = 0.15;
  double second = 4;  ///< strength of the second lamp
  bool same_place = false;
  int samples = 600;  ///< fewer than the default, for speed
  double off_m = 0;   ///< sigma of the places of the lamps
};

constexpr double kFirst = 2, kSecond = 4;  ///< strengths of the lamps

struct LitPixel {
  Vector3d at_m;
  int wall = 0;
  double first = 0, second = 0;  ///< light of a panel of strength 1
  bool is_lamp = false;
};

/// A panel's light at a place: 12 x 12 points.
double panel_share(const DrawnBox& box, const Vector3d& middle_m, const Vector3d& p,
                   const Vector3d& normal) {
  double sum = 0;
  constexpr int kSide = 12;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vector3d at = middle_m + Vector3d(((i + 0.5) / kSide - 0.5) * box.panel_m.x(),
                                              ((j + 0.5) / kSide - 0.5) * box.panel_m.y(), 0);
      const Vector3d to = at - p;
      const double d = to.norm();
      sum += std::max(0.0, normal.dot(to) / d) * std::max(0.0, to.z() / d) / (d * d);
    }
  return sum / (kSide * kSide);
}

const std::vector<LitPixel>& lit_pixels(const DrawnBox& box, Size size) {
  static const std::vector<LitPixel> all = [&] {
    std::vector<LitPixel> pixels;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Vector3d ray = model::direction_of(size, x, y);
        const auto hit = box.walls(box.scan_m(), ray);
        LitPixel p;
        p.at_m = box.scan_m() + hit.t * ray;
        p.wall = static_cast<int>(std::lround(Vector3d(1, 2, 3).dot(hit.normal))) + 3;
        p.first = panel_share(box, box.lamps[0].middle_m, p.at_m, hit.normal);
        p.second = panel_share(box, box.lamps[1].middle_m, p.at_m, hit.normal);
        p.is_lamp = box.on_panel(p.at_m);
        pixels.push_back(p);
      }
    return pixels;
  }();
  return all;
}

/// A number of a cube of space, -1 to 1.
double of_cube(const Vector3d& at_m, double side_m, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (int i = 0; i < 3; ++i) {
    hash ^= static_cast<std::uint64_t>(std::floor(at_m[i] / side_m) + 100);
    hash *= 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return static_cast<double>(hash >> 11) * 0x1p-52 - 1;
}

lights::FoundLamp panel_at(const DrawnBox& box, const Vector3d& middle_m) {
  lights::FoundLamp lamp;
  lamp.position_m = middle_m, lamp.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  lamp.direction = -Vector3d::UnitZ(), lamp.size_m = box.panel_m;
  return lamp;
}

Trial run(const ShadedScene& scene, std::uint64_t seed, Residuals&) {
  static const DrawnBox box;
  RandomGeometry random(seed);
  model::Panorama room = box.panorama();
  const auto& pixels = lit_pixels(box, room.size());
  std::array<double, 7> wall{};
  for (double& albedo : wall) albedo = random.uniform(0.35, 0.65);
  constexpr double kUniform = 1.7320508;  // half width over sigma
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const LitPixel& p = pixels[i];
    const double own = scene.patch_m > 0 ? kUniform * of_cube(p.at_m + Vector3d::Constant(1e-6),
                                                              scene.patch_m, seed)
                                         : random.normal();
    const double light = scene.ambient + kFirst * p.first + kSecond * p.second;
    const double albedo = wall[static_cast<std::size_t>(p.wall)] * (1 + scene.texture * own);
    const auto grey = srgb_byte_from_linear(static_cast<float>(scene.exposure * albedo * light));
    Rgb8& out = room.color.row(static_cast<int>(i) /
                               room.size().width)[i % static_cast<std::size_t>(room.size().width)];
    out = p.is_lamp ? Rgb8{255, 255, 255} : Rgb8{grey, grey, grey};
  }
  const lights::RoomSurfaces surfaces(std::move(room),
                                      {Eigen::Quaterniond::Identity(), box.scan_m()});
  const auto middle = [&](int i) -> Vector3d {
    const std::size_t lamp = scene.same_place ? 0 : static_cast<std::size_t>(i);
    return box.lamps[lamp].middle_m + random.normal3(scene.off_m).cwiseProduct(Vector3d(1, 1, 0));
  };
  const std::vector<lights::FoundLamp> lamps{panel_at(box, middle(0)), panel_at(box, middle(1))};
  estimation::Estimate<lights::RoomLight> estimate;
  Trial trial =
      timed([&] { return lights::measure_light(surfaces, lamps, {.most_samples = scene.samples}); },
            estimate);
  if (!estimate.usable()) return trial;
  // The share of the first lamp, and the ambient light, over the sum of the lamps.
  const lights::RoomLight& light = estimate.value;
  const double sum = light.intensity[0].y() + light.intensity[1].y(), is = kFirst + kSecond;
  trial.error = Eigen::Vector2d(light.intensity[0].y() / sum - kFirst / is,
                                light.ambient.y() / sum - scene.ambient / is);
  const std::array<int, 2> kept{0, 2};
  trial.covariance = estimate.covariance(kept, kept).eval();
  return trial;
}

}  // namespace

void add_shading_cases(std::vector<Case>& cases) {
  const auto add = case_adder<ShadedScene>(cases, "measure_light", run);
  add("walls of one colour each", Expect::kRobust, {.texture = 0});
  add("texture of pixels", Expect::kRobust, {});
  add("patches of 30 cm", Expect::kRobust, {.patch_m = 0.3});
  add("lamps 2 cm off", Expect::kRobust, {.off_m = 0.02});
  add("two lamps at one place", Expect::kRefusal, {.same_place = true});
  add("black", Expect::kRefusal, {.exposure = 1e-4});
  add("white", Expect::kRefusal, {.exposure = 1e3});
}

}  // namespace mixrig::estimation_bench
