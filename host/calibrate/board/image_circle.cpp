// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/image_circle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "hal/base/order_statistics.h"

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;
using Picture = ImageView<const std::uint8_t>;

constexpr double kLeastLight = 24;     // grey levels between the black border and what is lit
constexpr double kStepShare = 0.25;    // of that difference, where a side's first light begins
constexpr double kLeastSeen = 0.6;     // share of the rim inside the picture
constexpr double kLeastArc_rad = 1.0;  // of the rim that is seen
constexpr double kLeastOutside = 0.01, kMostLightOutside = 0.01;
constexpr double kTolerance = 0.01, kLeastTolerance_px = 2;  // of the radius
constexpr double kSoftest = 0.06;  // width of the rim's step over the radius
constexpr int kRimDirections = 720;

/// Grey levels that tell dark from light.
struct Levels {
  double black = 0, lit = 0;
  double step() const { return black + kStepShare * (lit - black); }
};

double median_of_patch(Picture picture, int left, int top, int side) {
  std::vector<double> values;
  for (int y = top; y < top + side; ++y)
    for (int x = left; x < left + side; ++x) values.push_back(picture.at(x, y));
  return upper_median(values);
}

/// Black: the second darkest corner, so that one may have stray light. Lit: a tenth is brighter.
Levels levels_of(Picture picture) {
  const Size size = picture.size;
  const int side = std::max(1, std::min(size.width, size.height) / 40);
  const int right = size.width - side, bottom = size.height - side;
  std::array<double, 4> corners{
      median_of_patch(picture, 0, 0, side), median_of_patch(picture, right, 0, side),
      median_of_patch(picture, 0, bottom, side), median_of_patch(picture, right, bottom, side)};
  std::sort(corners.begin(), corners.end());
  std::array<int, 256> count{};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) ++count[picture.at(x, y)];
  int lit = 255, brighter = count[255];
  const double tenth = 0.1 * static_cast<double>(size.area());
  while (lit > 0 && brighter < tenth) brighter += count[static_cast<std::size_t>(--lit)];
  return {corners[1], static_cast<double>(lit)};
}

/// The first light on the way from a pixel in steps of one pixel, between pixels; nullopt where it
/// is lit from the start, or never. One bright pixel alone is noise.
std::optional<Vector2d> first_light(Picture picture, int x, int y, int dx, int dy, double level) {
  const Size size = picture.size;
  const auto inside = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < size.width && v < size.height;
  };
  for (int i = 0; inside(x + dx, y + dy); ++i, x += dx, y += dy) {
    const double here = picture.at(x, y), next = picture.at(x + dx, y + dy);
    if (here <= level || next <= level) continue;
    if (i == 0) return std::nullopt;
    const double before = picture.at(x - dx, y - dy);
    const double back = std::clamp((here - level) / std::max(here - before, 1.0), 0.0, 1.0);
    return Vector2d(x - back * dx, y - back * dy);
  }
  return std::nullopt;
}

/// The first light from all four sides.
std::vector<Vector2d> border_of_light(Picture picture, double level) {
  constexpr int kLines = 400;
  const auto [width, height] = picture.size;
  std::vector<Vector2d> points;
  const auto add = [&](const std::optional<Vector2d>& point) {
    if (point) points.push_back(*point);
  };
  for (int y = 0; y < height; y += std::max(1, height / kLines)) {
    add(first_light(picture, 0, y, 1, 0, level));
    add(first_light(picture, width - 1, y, -1, 0, level));
  }
  for (int x = 0; x < width; x += std::max(1, width / kLines)) {
    add(first_light(picture, x, 0, 0, 1, level));
    add(first_light(picture, x, height - 1, 0, -1, level));
  }
  return points;
}

struct Circle {
  Vector2d center_px = Vector2d::Zero();
  double radius_px = 0;
  double off_px(const Vector2d& p) const { return (p - center_px).norm() - radius_px; }
  double tolerance_px() const { return std::max(kLeastTolerance_px, kTolerance * radius_px); }
};

/// Least squares of the distances (Gauss-Newton) from a start; false where the points do not
/// determine a circle.
bool fit_circle(const std::vector<Vector2d>& points, Circle& circle) {
  constexpr int kSteps = 10;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Vector2d& p : points) {
      const Vector2d from = p - circle.center_px;
      if (!(from.norm() > 0)) return false;
      const Eigen::Vector3d row(-from.x() / from.norm(), -from.y() / from.norm(), -1);
      normal += row * row.transpose();
      right -= circle.off_px(p) * row;
    }
    const Eigen::Vector3d move = normal.inverse() * right;
    if (!move.allFinite()) return false;
    circle.center_px += move.head<2>();
    circle.radius_px += move[2];
  }
  return circle.radius_px > 0;
}

/// The circle through three points; radius 0 where they lie on a line.
Circle through(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  Eigen::Matrix2d sides;
  sides << (b - a).transpose(), (c - a).transpose();
  if (std::abs(sides.determinant()) < 1e-6) return {};
  const Vector2d from_a =
      sides.inverse() * Vector2d(0.5 * (b - a).squaredNorm(), 0.5 * (c - a).squaredNorm());
  return {a + from_a, from_a.norm()};
}

bool plausible(const Circle& circle, Size size) {
  const double shorter = std::min(size.width, size.height);
  const Vector2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  return circle.radius_px > 0.2 * shorter &&
         circle.radius_px < 0.75 * std::hypot(size.width, size.height) && circle.off_px(middle) < 0;
}

/// The circle that most points lie on: random triples, then least squares.
std::optional<Circle> consensus_circle(const std::vector<Vector2d>& points, Size size) {
  constexpr std::size_t kFewest = 30;
  constexpr int kTriples = 1000;
  if (points.size() < kFewest) return std::nullopt;
  std::mt19937 random(1);
  const auto pick = [&] { return points[random() % points.size()]; };
  Circle best;
  std::ptrdiff_t most = 0;
  for (int i = 0; i < kTriples; ++i) {
    const Vector2d a = pick(), b = pick(), c = pick();
    const Circle circle = through(a, b, c);
    if (!plausible(circle, size)) continue;
    const auto on = std::count_if(points.begin(), points.end(), [&](const Vector2d& p) {
      return std::abs(circle.off_px(p)) < circle.tolerance_px();
    });
    if (on > most) most = on, best = circle;
  }
  if (most < static_cast<std::ptrdiff_t>(kFewest)) return std::nullopt;
  std::vector<Vector2d> on;
  for (const Vector2d& p : points)
    if (std::abs(best.off_px(p)) < best.tolerance_px()) on.push_back(p);
  if (!fit_circle(on, best) || !plausible(best, size)) return std::nullopt;
  return best;
}

bool on_picture(const Vector2d& p, Size size) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= size.width - 1 && p.y() <= size.height - 1;
}

double bilinear(Picture picture, const Vector2d& p) {
  const int x = std::min(static_cast<int>(p.x()), picture.size.width - 2);
  const int y = std::min(static_cast<int>(p.y()), picture.size.height - 2);
  const double s = p.x() - x, t = p.y() - y;
  return (1 - t) * ((1 - s) * picture.at(x, y) + s * picture.at(x + 1, y)) +
         t * ((1 - s) * picture.at(x, y + 1) + s * picture.at(x + 1, y + 1));
}

/// How many values lie before the first that reaches a level.
double crossing(const std::vector<double>& inward, double level) {
  std::size_t i = 0;
  while (i < inward.size() && inward[i] < level) ++i;
  return static_cast<double>(i);
}

/// Half way up the step of light on the rim in one direction; nullopt where there is none near the
/// circle, or a soft one.
std::optional<Vector2d> rim_point(Picture picture, const Levels& levels, const Circle& circle,
                                  const Vector2d& out) {
  constexpr double kOuter = 1.05, kInner = 0.92, kSteps = 120;
  const double step = (kOuter - kInner) * circle.radius_px / kSteps;
  std::vector<double> inward;
  double first_px = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double radius = kOuter * circle.radius_px - i * step;
    const Vector2d at = circle.center_px + radius * out;
    if (!on_picture(at, picture.size)) continue;
    if (inward.empty()) first_px = radius;
    inward.push_back(bilinear(picture, at));
  }
  if (static_cast<int>(inward.size()) < kSteps / 2) return std::nullopt;
  const double low = *std::min_element(inward.begin(), inward.end());
  const double high = *std::max_element(inward.begin(), inward.end());
  if (high < levels.step() || low > levels.step()) return std::nullopt;
  const auto at_share = [&](double share) { return crossing(inward, low + share * (high - low)); };
  if ((at_share(0.7) - at_share(0.3)) * step > kSoftest * circle.radius_px) return std::nullopt;
  return circle.center_px + (first_px - at_share(0.5) * step) * out;
}

/// The points of the rim that are seen, and how many directions have the rim inside the picture.
struct Rim {
  std::vector<Vector2d> points;
  int directions = 0;
};
Rim look_at_rim(Picture picture, const Levels& levels, const Circle& circle) {
  Rim rim;
  for (int i = 0; i < kRimDirections; ++i) {
    const double phi = i * 2 * M_PI / kRimDirections;
    const Vector2d out(std::cos(phi), std::sin(phi));
    if (!on_picture(circle.center_px + circle.radius_px * out, picture.size)) continue;
    ++rim.directions;
    const auto point = rim_point(picture, levels, circle, out);
    if (point && std::abs(circle.off_px(*point)) < circle.tolerance_px())
      rim.points.push_back(*point);
  }
  return rim;
}

/// Most of the picture outside the circle is there, and dark.
bool dark_outside(Picture picture, const Levels& levels, const Circle& circle) {
  constexpr double kOutside = 1.03;
  const Size size = picture.size;
  const double limit = kOutside * circle.radius_px;
  double outside = 0, light = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if ((Vector2d(x, y) - circle.center_px).squaredNorm() < limit * limit) continue;
      outside += 1;
      light += picture.at(x, y) > levels.step() ? 1 : 0;
    }
  return outside > kLeastOutside * static_cast<double>(size.area()) &&
         light <= kMostLightOutside * outside;
}

}  // namespace

void BrightestPicture::add(Picture picture) {
  if (image_.size().empty()) image_ = Image<std::uint8_t>(picture.size, 0);
  if (picture.size != image_.size()) return;
  for (int y = 0; y < picture.size.height; ++y)
    for (int x = 0; x < picture.size.width; ++x)
      image_.at(x, y) = std::max(image_.at(x, y), picture.at(x, y));
}

std::optional<ImageCircle> find_image_circle(Picture picture) {
  const Size size = picture.size;
  constexpr int kSmallest_px = 40;
  if (std::min(size.width, size.height) < kSmallest_px) return std::nullopt;
  const Levels levels = levels_of(picture);
  if (levels.lit - levels.black < kLeastLight) return std::nullopt;
  auto circle = consensus_circle(border_of_light(picture, levels.step()), size);
  if (!circle) return std::nullopt;
  Rim rim;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    rim = look_at_rim(picture, levels, *circle);
    const double step_rad = 2 * M_PI / kRimDirections;
    if (static_cast<double>(rim.points.size()) * step_rad < kLeastArc_rad ||
        !fit_circle(rim.points, *circle) || !plausible(*circle, size))
      return std::nullopt;
  }
  ImageCircle found{circle->center_px, circle->radius_px, 0, 0};
  for (const Vector2d& p : rim.points) found.residual_px += std::pow(circle->off_px(p), 2);
  const auto points = static_cast<double>(rim.points.size());
  found.residual_px = std::sqrt(found.residual_px / points);
  found.seen = points / rim.directions;
  if (found.seen < kLeastSeen || !dark_outside(picture, levels, *circle)) return std::nullopt;
  return found;
}

}  // namespace mixrig::calibration
