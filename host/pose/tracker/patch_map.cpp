// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/patch_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::tracking {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using std::numbers::pi;

constexpr float kUnknown = -1;
constexpr double kSteepest_rad = 80 * pi / 180;  ///< largest elevation of a patch
/// Pixel size above which depth steps are ignored: a coarser level smooths over them anyway.
constexpr double kStepsMatter_rad = 0.012;
constexpr float kLeastContrast = 2;  ///< smallest standard deviation of grey values, of 255
constexpr double kLeastKnown = 0.75;

float luma(const Rgb8& c) {
  return 0.299F * static_cast<float>(c.r) + 0.587F * static_cast<float>(c.g) +
         0.114F * static_cast<float>(c.b);
}

/// Averages `factor` x `factor` pixels; unknown where one of them is.
Image<float> grey_of(const Image<Rgb8>& color, int factor) {
  Image<float> grey({color.width() / factor, color.height() / factor});
  const float share = 1.0F / static_cast<float>(factor * factor);
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x) {
      float sum = 0;
      bool known = true;
      for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i) {
          const Rgb8& c = color.row(y * factor + j)[x * factor + i];
          known = known && (c.r != 0 || c.g != 0 || c.b != 0);
          sum += luma(c);
        }
      grey.row(y)[x] = known ? sum * share : kUnknown;
    }
  return grey;
}

Image<float> halved(const Image<float>& from) {
  Image<float> to({from.width() / 2, from.height() / 2});
  for (int y = 0; y < to.height(); ++y)
    for (int x = 0; x < to.width(); ++x) {
      const float *a = from.row(2 * y) + 2 * x, *b = from.row(2 * y + 1) + 2 * x;
      const bool known = a[0] >= 0 && a[1] >= 0 && b[0] >= 0 && b[1] >= 0;
      to.row(y)[x] = known ? 0.25F * (a[0] + a[1] + b[0] + b[1]) : kUnknown;
    }
  return to;
}

/// One level of the room's picture, and the room's distances at its pixels.
struct Level {
  Image<float> grey;
  const model::Panorama& room;
  double pixel_rad = 0;

  /// Returns the number of columns that one pixel of a patch covers in row y.
  int stride(int y) const {
    const double elevation = pi * (0.5 - (y + 0.5) / grey.height());
    return std::clamp(static_cast<int>(std::lround(1 / std::cos(elevation))), 1, 8);
  }
  /// Returns the mean of `stride` columns from x on.
  float value(int x, int y, int stride) const {
    const float* row = grey.row(y);
    float sum = 0;
    for (int i = 0; i < stride; ++i) {
      const float v = row[(x + i + grey.width()) % grey.width()];
      if (v < 0) return kUnknown;
      sum += v;
    }
    return sum / static_cast<float>(stride);
  }
  Vector3d direction(double x, double y) const {
    const double azimuth = pi * (1 - 2 * (x + 0.5) / grey.width());
    const double elevation = pi * (0.5 - (y + 0.5) / grey.height());
    return {-std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
            std::sin(elevation)};
  }
  /// Returns the pixel of the room's distances at a position of this level.
  std::pair<int, int> at(double x, double y) const {
    const double scale_x = static_cast<double>(room.size().width) / grey.width();
    const double scale_y = static_cast<double>(room.size().height) / grey.height();
    const int px = static_cast<int>(std::lround((x + 0.5) * scale_x - 0.5));
    const int py = static_cast<int>(std::lround((y + 0.5) * scale_y - 0.5));
    return {(px + room.size().width) % room.size().width,
            std::clamp(py, 0, room.size().height - 1)};
  }
};

/// Returns the distance at a position between pixels; the inverse is interpolated unless there is a
/// depth step.
float distance_between(const Level& level, double x, double y) {
  const Image<float>& d = level.room.distance_m;
  const double fx = (x + 0.5) * d.width() / level.grey.width() - 0.5;
  const double fy = (y + 0.5) * d.height() / level.grey.height() - 0.5;
  const int left = static_cast<int>(std::floor(fx)), top = static_cast<int>(std::floor(fy));
  const auto x0 = (left + d.width()) % d.width(), x1 = (left + 1 + d.width()) % d.width();
  const int y0 = std::clamp(top, 0, d.height() - 1), y1 = std::clamp(top + 1, 0, d.height() - 1);
  const std::array<float, 4> four{d.row(y0)[x0], d.row(y0)[x1], d.row(y1)[x0], d.row(y1)[x1]};
  const auto [low, high] = std::minmax_element(four.begin(), four.end());
  if (*low <= 0 || model::is_depth_step(*low, *high)) {
    const auto [nx, ny] = level.at(x, y);
    return d.row(ny)[nx];
  }
  const auto u = static_cast<float>(fx - left), v = static_cast<float>(fy - top);
  return 1 / ((1 - v) * ((1 - u) / four[0] + u / four[1]) + v * ((1 - u) / four[2] + u / four[3]));
}

/// Side of a patch with a border of one pixel.
constexpr int kWide = kWidePatch;
using WideGrey = std::array<float, kWide * kWide>;

bool read_wide(const Level& level, int x, int y, int stride, WideGrey& out) {
  int known = 0;
  for (int j = 0; j < kWide; ++j)
    for (int i = 0; i < kWide; ++i) {
      const float v = level.value(x + (i - 1) * stride, y + j - 1, stride);
      out[static_cast<std::size_t>(j * kWide + i)] = v;
      known += v >= 0 ? 1 : 0;
    }
  return known >= kLeastKnown * kWide * kWide;
}

/// Sets the positions of the pixels; false if they are unknown or lie on two surfaces.
bool fill_places(const Level& level, int x, int y, int stride, Patch& p) {
  std::array<Vector3d, kPatchPixels> places;
  std::array<float, kPatchPixels> distances{};
  int known = 0;
  for (int v = 0; v < kPatchSide; ++v)
    for (int u = 0; u < kPatchSide; ++u) {
      const auto k = static_cast<std::size_t>(v * kPatchSide + u);
      const double at_x = x + u * stride + 0.5 * (stride - 1), at_y = y + v;
      distances[k] = distance_between(level, at_x, at_y);
      places[k] = distances[k] * level.direction(at_x, at_y);
      p.share[k] = distances[k] > 0 ? 1.0F : 0.0F;
      known += distances[k] > 0 ? 1 : 0;
    }
  if (known < kLeastKnown * kPatchPixels) return false;
  if (level.pixel_rad < kStepsMatter_rad)
    for (std::size_t k = 0; k < kPatchPixels; ++k) {
      const auto step = [&](std::size_t other) {
        const auto [low, high] = std::minmax(distances[k], distances[other]);
        return low <= 0 || model::is_depth_step(low, high);
      };
      if ((k % kPatchSide > 0 && step(k - 1)) || (k >= kPatchSide && step(k - kPatchSide)))
        return false;
    }
  set_places(places, Vector3d::Zero(), p);
  p.range_m = p.centre_m.norm();
  return true;
}

/// Returns the level whose pixel is nearest to `finest_rad`. It averages whole pixels of the room's
/// colour, without a remainder that would shift it.
Level finest_level(const model::Panorama& room, double finest_rad) {
  const double own_rad = 2 * pi / room.color.width();
  int factor = 1;
  const auto off = [&](int f) { return std::abs(std::log(f * own_rad / finest_rad)); };
  for (int f = 2; f <= room.color.height() / (4 * kWide); ++f)
    if (room.color.width() % f == 0 && room.color.height() % f == 0 && off(f) < off(factor))
      factor = f;
  return {grey_of(room.color, factor), room, own_rad * factor};
}

/// Divides all directions into cells of about equal solid angle: bands of elevation, each divided
/// into cells that are about square.
class Cells {
 public:
  explicit Cells(int count)
      : rows_(std::max(1, static_cast<int>(std::lround(std::sqrt(pi * count) / 2)))) {
    for (int r = 0; r < rows_; ++r) {
      first_.push_back(total_);
      const double elevation = pi * (0.5 - (r + 0.5) / rows_);
      total_ += std::max(1, static_cast<int>(std::lround(2 * rows_ * std::cos(elevation))));
    }
    first_.push_back(total_);
  }
  int total() const { return total_; }
  int of(double x_share, double y_share) const {
    const int row = std::clamp(static_cast<int>(y_share * rows_), 0, rows_ - 1);
    const int in_row =
        first_[static_cast<std::size_t>(row) + 1] - first_[static_cast<std::size_t>(row)];
    const int column = std::clamp(static_cast<int>(x_share * in_row), 0, in_row - 1);
    return first_[static_cast<std::size_t>(row)] + column;
  }

 private:
  int rows_, total_ = 0;
  std::vector<int> first_;
};

struct Candidate {
  float score = 0;
  int x = -1, y = -1;
};

/// Scores rows [begin, end) by their gradients alone.
void score_rows(const Level& level, int begin, int end, Image<float>& scores) {
  WideGrey wide{};
  Patch p;
  for (int y = begin; y < end; ++y) {
    const double elevation = pi * (0.5 - (y + 0.5 * kPatchSide) / level.grey.height());
    if (std::abs(elevation) > kSteepest_rad) continue;
    const int stride = level.stride(y + kPatchSide / 2);
    for (int x = 0; x < level.grey.width(); x += stride) {
      if (!read_wide(level, x, y, stride, wide)) continue;
      p.share.fill(1);
      set_look(wide, p);
      if (has_contrast(p)) scores.row(y)[x] = p.score;
    }
  }
}

std::vector<Patch> patches_of(const Level& level, int count, Crew& crew) {
  Image<float> scores(level.grey.size());
  crew.rows(level.grey.height() - kWide, 8,
            [&](int begin, int end) { score_rows(level, begin + 1, end + 1, scores); });
  const Cells cells(count);
  // Candidates per cell: several, since the best may lie across a depth step.
  constexpr std::size_t kTries = 6;
  std::vector<std::array<Candidate, kTries>> best(static_cast<std::size_t>(cells.total()));
  for (int y = 0; y < scores.height(); ++y)
    for (int x = 0; x < scores.width(); ++x) {
      Candidate c{scores.row(y)[x], x, y};
      if (c.score <= 0) continue;
      auto& of_cell = best[static_cast<std::size_t>(
          cells.of((x + 0.5) / scores.width(), (y + 0.5 * kPatchSide) / scores.height()))];
      for (Candidate& kept : of_cell)
        if (c.score > kept.score) std::swap(c, kept);
    }
  std::vector<Patch> patches;
  for (const auto& of_cell : best)
    for (const Candidate& c : of_cell) {
      if (c.x < 0) break;
      const int stride = level.stride(c.y + kPatchSide / 2);
      Patch p;
      WideGrey wide{};
      if (!fill_places(level, c.x, c.y, stride, p)) continue;
      if (!read_wide(level, c.x, c.y, stride, wide)) continue;
      set_look(wide, p);
      if (p.known < kLeastKnown * kPatchPixels) continue;
      const auto [px, py] = level.at(c.x + 0.5 * kPatchSide * stride, c.y + 0.5 * kPatchSide);
      p.sigma_m = level.room.sigma_m.row(py)[px];
      p.pixel_rad = static_cast<float>(level.pixel_rad);
      patches.push_back(p);
      break;
    }
  return patches;
}

float score_of(const Patch& p) {
  const float mean = 0.5F * (p.uu + p.vv);
  const float half = std::hypot(0.5F * (p.uu - p.vv), p.uv);
  return mean - half + 0.05F * (mean + half);
}

}  // namespace

void set_places(const std::array<Vector3d, kPatchPixels>& places, const Vector3d& eye_m, Patch& p) {
  Vector3d centre = Vector3d::Zero();
  double known = 0;
  for (std::size_t k = 0; k < kPatchPixels; ++k)
    if (p.share[k] > 0) centre += places[k], known += 1;
  centre /= known;
  p.centre_m = centre.cast<float>();
  Vector3d along_u = Vector3d::Zero(), along_v = Vector3d::Zero();
  double squares = 0;
  for (std::size_t k = 0; k < kPatchPixels; ++k) {
    const Vector3d off = p.share[k] > 0 ? Vector3d(places[k] - centre) : Vector3d::Zero();
    p.x_m[k] = static_cast<float>(off.x()), p.y_m[k] = static_cast<float>(off.y());
    p.z_m[k] = static_cast<float>(off.z());
    const double u = static_cast<int>(k % kPatchSide) - 0.5 * (kPatchSide - 1);
    const double v = static_cast<int>(k / kPatchSide) - 0.5 * (kPatchSide - 1);
    along_u += u * off, along_v += v * off;
    squares += p.share[k] * u * u;
  }
  p.u_m = (along_u / squares).cast<float>(), p.v_m = (along_v / squares).cast<float>();
  p.normal = p.u_m.cross(p.v_m).normalized();
  if (p.normal.dot(p.centre_m - eye_m.cast<float>()) > 0) p.normal = -p.normal;
}

bool has_contrast(const Patch& p) { return p.energy >= p.known * kLeastContrast * kLeastContrast; }

void set_look(const std::array<float, kWidePatch * kWidePatch>& wide, Patch& p) {
  float mean = 0, mean_u = 0, mean_v = 0;
  p.known = 0;
  for (int v = 0; v < kPatchSide; ++v)
    for (int u = 0; u < kPatchSide; ++u) {
      const auto k = static_cast<std::size_t>(v * kPatchSide + u);
      const auto w = static_cast<std::size_t>((v + 1) * kWide + u + 1);
      const bool all = p.share[k] > 0 && wide[w] >= 0 && wide[w - 1] >= 0 && wide[w + 1] >= 0 &&
                       wide[w - kWide] >= 0 && wide[w + kWide] >= 0;
      p.share[k] = all ? 1.0F : 0.0F;
      p.grey[k] = all ? wide[w] : 0;
      p.grey_u[k] = all ? 0.5F * (wide[w + 1] - wide[w - 1]) : 0;
      p.grey_v[k] = all ? 0.5F * (wide[w + kWide] - wide[w - kWide]) : 0;
      p.known += p.share[k];
      mean += p.grey[k], mean_u += p.grey_u[k], mean_v += p.grey_v[k];
    }
  if (p.known == 0) return;
  mean /= p.known, mean_u /= p.known, mean_v /= p.known;
  p.energy = p.uu = p.uv = p.vv = 0;
  for (std::size_t k = 0; k < kPatchPixels; ++k) {
    p.grey[k] = p.share[k] * (p.grey[k] - mean);
    p.grey_u[k] = p.share[k] * (p.grey_u[k] - mean_u);
    p.grey_v[k] = p.share[k] * (p.grey_v[k] - mean_v);
    p.energy += p.grey[k] * p.grey[k];
    p.uu += p.grey_u[k] * p.grey_u[k];
    p.uv += p.grey_u[k] * p.grey_v[k];
    p.vv += p.grey_v[k] * p.grey_v[k];
  }
  p.score = score_of(p);
}

PatchMap make_patch_map(const model::Panorama& room, const PatchMapOptions& options, Crew& crew) {
  PatchMap map;
  map.distance_m = room.distance_m;
  Level level = finest_level(room, options.finest_rad);
  for (int k = 0; k < options.levels && level.grey.height() >= 3 * kWide; ++k) {
    // Patches of a level overlap by half a side at most.
    const double room_for = 4 * pi / std::pow(0.5 * kPatchSide * level.pixel_rad, 2);
    map.levels.push_back(
        patches_of(level, static_cast<int>(std::min<double>(options.patches, room_for)), crew));
    if (level.grey.width() % 2 != 0 || level.grey.height() % 2 != 0) break;
    Image<float> next = halved(level.grey);
    level.grey = std::move(next), level.pixel_rad *= 2;
  }
  return map;
}

bool PatchMap::hidden(const Eigen::Vector3f& eye_m, const Eigen::Vector3f& point_m) const {
  if (distance_m.empty()) return false;
  constexpr int kSteps = 12;
  constexpr float kBehind = 1.03F;
  for (int i = 1; i < kSteps; ++i) {
    const float share = static_cast<float>(i) / kSteps;
    const Vector3f at = eye_m + share * (point_m - eye_m);
    const float range_m = at.norm();
    if (range_m < 0.1F) continue;
    const float azimuth = std::atan2(-at.x(), at.y()), elevation = std::asin(at.z() / range_m);
    const auto width = static_cast<float>(distance_m.width());
    const auto height = static_cast<float>(distance_m.height());
    const int x = static_cast<int>((0.5F - azimuth / (2 * static_cast<float>(pi))) * width);
    const int y = static_cast<int>((0.5F - elevation / static_cast<float>(pi)) * height);
    const float seen_m = distance_m.row(
        std::clamp(y, 0, distance_m.height() - 1))[std::clamp(x, 0, distance_m.width() - 1)];
    if (seen_m > 0 && range_m > kBehind * seen_m) return true;
  }
  return false;
}

}  // namespace mixrig::tracking
