// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/lens_table.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace mixrig::geometry {
namespace {

constexpr double kMostShift_m = 1;

/// Powers of the ray's length that multiply the coefficients k1 k2 p1 p2 k3 k4 k5 k6, relative to
/// the ray itself.
constexpr std::array<int, 8> kPowers{2, 4, 1, 1, 6, 2, 4, 6};

/// Half the picture's diagonal over the focal length.
double corner_ray(const Pinhole& p) {
  return 0.5 * std::hypot(p.size_px.width / p.fx_px, p.size_px.height / p.fy_px);
}

/// Slope at sample i of a monotone cubic: the weighted harmonic mean of its neighbours' slopes, at
/// the ends that of a parabola, as far as it stays monotone.
template <typename At>
double slope_at(std::span<const double> x, At&& y, std::size_t i) {
  const auto secant = [&](std::size_t k) { return (y(k + 1) - y(k)) / (x[k + 1] - x[k]); };
  const std::size_t last = x.size() - 1;
  if (i > 0 && i < last) {
    const double a = secant(i - 1), b = secant(i);
    if (!(a * b > 0)) return 0;
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    const double wa = 2 * after + before, wb = after + 2 * before;
    return (wa + wb) / (wa / a + wb / b);
  }
  const std::size_t first = i == 0 ? 0 : last - 1;
  const double near = secant(first);
  if (x.size() == 2) return near;
  const std::size_t second = i == 0 ? 1 : last - 2;
  const double far = secant(second);
  const double h = x[first + 1] - x[first], next = x[second + 1] - x[second];
  const double slope = ((2 * h + next) * near - h * far) / (h + next);
  if (slope * near <= 0) return 0;
  return near * far <= 0 && std::abs(slope) > 3 * std::abs(near) ? 3 * near : slope;
}

/// Value at t, which lies in [x.front(), x.back()]; y(i) is the value at x[i].
template <typename At>
double monotone_cubic(std::span<const double> x, At&& y, double t) {
  if (x.size() == 1) return y(0);
  const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, t);
  const auto i = static_cast<std::size_t>(above - x.begin()) - 1;
  const double h = x[i + 1] - x[i], s = (t - x[i]) / h;
  const double d0 = slope_at(x, y, i), d1 = slope_at(x, y, i + 1);
  const double rise = y(i + 1) - y(i);
  return y(i) + s * (h * d0 + s * (3 * rise - h * (2 * d0 + d1) + s * (h * (d0 + d1) - 2 * rise)));
}

std::vector<double> sorted_once(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Error wrong(const LensNode& node, const std::string& what) {
  return {ErrorCode::kData,
          fmt::format("node zoom {:g}, focus {:g}: {}", node.at.zoom, node.at.focus, what)};
}

Result<void> check_node(const LensNode& node, Size size_px) {
  if (!std::isfinite(node.at.zoom) || !std::isfinite(node.at.focus))
    return wrong(node, "zoom and focus must be finite");
  if (node.lens.camera.size_px() != size_px)
    return wrong(node, "was made of pictures of another size: calibrate all nodes at one size");
  if (!(std::abs(node.lens.pupil_shift_m) <= kMostShift_m))
    return wrong(node, "the pupil shift must lie in -1..1 m");
  if (!(node.residual_px >= 0 && std::isfinite(node.residual_px)))
    return wrong(node, "the residual must not be negative");
  if (const auto valid = validate(node.lens.camera); !valid)
    return wrong(node, valid.error().context);
  return {};
}

}  // namespace

LensTable::Values LensTable::values_of(const LensState& lens) {
  const Pinhole& p = lens.camera.pinhole;
  Values v{std::log(p.fx_px), p.fy_px / p.fx_px, p.cx_px, p.cy_px};
  const double corner = corner_ray(p);
  for (std::size_t i = 0; i < kPowers.size(); ++i)
    v[4 + i] = lens.camera.lens.coefficients()[i] * std::pow(corner, kPowers[i]);
  v[12] = lens.pupil_shift_m;
  return v;
}

LensState LensTable::state_of(const Values& v, Size size_px) {
  const double fx_px = std::exp(v[0]);
  const Pinhole pinhole{size_px, fx_px, fx_px * v[1], v[2], v[3]};
  const double corner = corner_ray(pinhole);
  Lens::Coefficients k;
  for (std::size_t i = 0; i < kPowers.size(); ++i) k[i] = v[4 + i] / std::pow(corner, kPowers[i]);
  return {{pinhole, Lens(k)}, v[12]};
}

Result<LensTable> LensTable::make(std::vector<LensNode> nodes) {
  if (nodes.size() < 2)
    return Error{ErrorCode::kData, "a lens table needs two nodes or more: calibrate more settings"};
  LensTable table;
  for (const LensNode& node : nodes) {
    MIXRIG_TRY(check_node(node, nodes.front().lens.camera.size_px()));
    table.zooms_.push_back(node.at.zoom);
    table.focuses_.push_back(node.at.focus);
  }
  table.zooms_ = sorted_once(std::move(table.zooms_));
  table.focuses_ = sorted_once(std::move(table.focuses_));
  const std::size_t zooms = table.zooms_.size(), focuses = table.focuses_.size();
  if (zooms > kMostZooms || focuses > kMostFocuses)
    return Error{ErrorCode::kData,
                 fmt::format("{} x {} values of zoom and focus, at most {} x {} are read: leave "
                             "some out",
                             zooms, focuses, kMostZooms, kMostFocuses)};
  if (nodes.size() != zooms * focuses)
    return Error{ErrorCode::kData,
                 fmt::format("{} nodes are not a grid of {} values of zoom and {} of focus: give "
                             "one node for each pair",
                             nodes.size(), zooms, focuses)};
  std::sort(nodes.begin(), nodes.end(), [](const LensNode& a, const LensNode& b) {
    return a.at.zoom != b.at.zoom ? a.at.zoom < b.at.zoom : a.at.focus < b.at.focus;
  });
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].at != LensEncoders{table.zooms_[i / focuses], table.focuses_[i % focuses]})
      return wrong(nodes[i], "is there twice, or its place in the grid is empty: correct it");
  for (const LensNode& node : nodes) table.values_.push_back(values_of(node.lens));
  table.nodes_ = std::move(nodes);
  MIXRIG_TRY(table.check_between());
  return table;
}

/// Checks that the lens is valid midway between nodes, too.
Result<void> LensTable::check_between() const {
  const auto middles = [](const std::vector<double>& x) {
    std::vector<double> out = x;
    for (std::size_t i = 1; i < x.size(); ++i) out.push_back(0.5 * (x[i - 1] + x[i]));
    return out;
  };
  for (const double zoom : middles(zooms_))
    for (const double focus : middles(focuses_))
      if (const auto valid = validate(at({zoom, focus}).camera); !valid)
        return wrong({{zoom, focus}, {}, 0}, "between the nodes: " + valid.error().context);
  return {};
}

bool LensTable::contains(const LensEncoders& e) const {
  return e.zoom >= zooms_.front() && e.zoom <= zooms_.back() &&
         (focuses_.size() == 1 || (e.focus >= focuses_.front() && e.focus <= focuses_.back()));
}

LensState LensTable::at(const LensEncoders& e) const {
  // The order of min and max maps NaN to the first node.
  const double zoom = std::min(std::max(zooms_.front(), e.zoom), zooms_.back());
  const double focus = std::min(std::max(focuses_.front(), e.focus), focuses_.back());
  const std::size_t columns = focuses_.size();
  Values values{};
  for (std::size_t k = 0; k < kValues; ++k) {
    std::array<double, kMostFocuses> along{};
    for (std::size_t j = 0; j < columns; ++j)
      along[j] = monotone_cubic(
          zooms_, [&](std::size_t i) { return values_[i * columns + j][k]; }, zoom);
    values[k] = monotone_cubic(
        focuses_, [&](std::size_t j) { return along[j]; }, focus);
  }
  return state_of(values, nodes_.front().lens.camera.size_px());
}

double largest_shift_px(const LensState& a, const LensState& b, double z_m) {
  double most = 0;
  const Size size = a.camera.size_px();
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector2d px((i % 3) * 0.5 * (size.width - 1), (i / 3) * 0.5 * (size.height - 1));
    const auto ray = a.camera.unproject(px);
    if (!ray) continue;
    const Eigen::Vector3d point_m(ray->x() * z_m, ray->y() * z_m,
                                  z_m + a.pupil_shift_m - b.pupil_shift_m);
    const auto seen = b.camera.project(point_m);
    if (seen) most = std::max(most, (*seen - px).norm());
  }
  return most;
}

Pose at_pupil(const Pose& world_from_camera, double pupil_shift_m) {
  Pose moved = world_from_camera;
  moved.translation_m += moved.rotation * Eigen::Vector3d(0, 0, pupil_shift_m);
  return moved;
}

}  // namespace mixrig::geometry
