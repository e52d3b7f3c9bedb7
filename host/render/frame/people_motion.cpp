// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/people_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixrig::render {
namespace {

constexpr int kAcross = 160;    ///< about so many samples along a row of the view
constexpr int kLeastShown = 4;  ///< least samples with people among the 16 of a cell
/// Neighbouring cells whose 1/z differ by at most this part are one cluster.
constexpr float kOneBody = 0.1F;
/// A motion must reduce the difference below this part of that at rest.
constexpr float kStays = 0.85F;
/// Cost of a cell's motion for each sample off its cluster's, of 255.
constexpr float kBendCost = 1.0F;
constexpr int kMostClusters = 32;
/// Smaller clusters stand still: they are wrong depth of the room.
constexpr std::size_t kLeastCells = 6;

/// Pointer to the sample (x, y), past the margin.
const float* light_at(const PeopleSamples& s, int x, int y) {
  return s.light.row(y + kMotionReach) + x + kMotionReach;
}

/// Sub-sample place, -0.5 .. 0.5, of the minimum of a parabola through three values.
float least_between(float left, float middle, float right) {
  const float bend = left - 2 * middle + right;
  return bend > 0 ? std::clamp(0.5F * (left - right) / bend, -0.5F, 0.5F) : 0.0F;
}

}  // namespace

ClusterMotion::ClusterMotion(Size samples)
    : size_(samples),
      cells_{(samples.width + kMotionCell - 1) / kMotionCell,
             (samples.height + kMotionCell - 1) / kMotionCell},
      cell_w_(cells_),
      label_(cells_),
      spread_(cells_),
      next_spread_(cells_),
      motion_(cells_),
      costs_(cells_.area()) {
  cluster_.reserve(cells_.area());
}

const Image<glm::vec2>& ClusterMotion::find(const PeopleSamples& now, const PeopleSamples& before) {
  label(now);
  label_.fill(0), motion_.fill(glm::vec2(0));
  std::uint8_t label = 0;
  for (int y = 0; y < cells_.height; ++y)
    for (int x = 0; x < cells_.width; ++x) {
      if (!(cell_w_.row(y)[x] > 0) || label_.row(y)[x] != 0 || label == kMostClusters) continue;
      grow({x, y}, ++label);
      if (cluster_.size() >= kLeastCells) move_cluster(now, before, label);
    }
  spread();
  return motion_;
}

/// Mean inverse depth of people in each cell, where enough samples show them.
void ClusterMotion::label(const PeopleSamples& now) {
  for (int y = 0; y < cells_.height; ++y)
    for (int x = 0; x < cells_.width; ++x) {
      float sum = 0;
      int count = 0;
      for (int j = y * kMotionCell; j < std::min(size_.height, (y + 1) * kMotionCell); ++j)
        for (int i = x * kMotionCell; i < std::min(size_.width, (x + 1) * kMotionCell); ++i)
          if (const float w = now.w.row(j)[i]; w > 0) sum += w, ++count;
      cell_w_.row(y)[x] = count >= kLeastShown ? sum / static_cast<float>(count) : 0;
    }
}

/// Collects the cells connected with `from` into cluster_.
void ClusterMotion::grow(Place from, std::uint8_t label) {
  cluster_.clear();
  cluster_.push_back(from);
  label_.row(from.y)[from.x] = label;
  for (std::size_t k = 0; k < cluster_.size(); ++k) {
    const Place at = cluster_[k];
    const float w = cell_w_.row(at.y)[at.x];
    for (const Place d : {Place{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const int x = at.x + d.x, y = at.y + d.y;
      if (x < 0 || y < 0 || x >= cells_.width || y >= cells_.height) continue;
      const float beside = cell_w_.row(y)[x];
      if (!(beside > 0) || label_.row(y)[x] != 0) continue;
      if (std::abs(beside - w) > kOneBody * std::max(beside, w)) continue;
      label_.row(y)[x] = label;
      cluster_.push_back({x, y});
    }
  }
}

/// Best shift by every fourth sample of the cluster. Shifts along a row lie side by side in the
/// picture before, the last one first.
glm::ivec2 ClusterMotion::best_of_cluster(const PeopleSamples& now, const PeopleSamples& before) {
  std::array<std::array<float, kSide>, kSide> costs{};
  for (const Place cell : cluster_)
    for (int k = 0; k < kMotionCell; ++k) {
      // One sample of each row and column of a cell.
      const int x = cell.x * kMotionCell + (2 * k + k / 2) % kMotionCell;
      const int y = cell.y * kMotionCell + k;
      if (x >= size_.width || y >= size_.height || !(now.w.row(y)[x] > 0)) continue;
      const float light = *light_at(now, x, y);
      for (int j = 0; j < kSide; ++j) {
        const float* then = light_at(before, x - kMotionReach, y + kMotionReach - j);
        auto& row = costs[static_cast<std::size_t>(j)];
        for (std::size_t i = 0; i < kSide; ++i) row[i] += std::abs(light - then[i]);
      }
    }
  costs[kMotionReach][kMotionReach] *= kStays;
  glm::ivec2 best(0);
  float least = std::numeric_limits<float>::max();
  for (int dy = -kMotionReach; dy <= kMotionReach; ++dy)
    for (int dx = -kMotionReach; dx <= kMotionReach; ++dx) {
      const float cost = costs[static_cast<std::size_t>(dy + kMotionReach)]
                              [static_cast<std::size_t>(kMotionReach - dx)];
      if (cost < least) least = cost, best = {dx, dy};
    }
  return best;
}

void ClusterMotion::cost_of_cell(const PeopleSamples& now, const PeopleSamples& before, Place cell,
                                 glm::ivec2 around) {
  auto& costs = costs_[static_cast<std::size_t>(cell.y * cells_.width + cell.x)];
  costs.fill(0);
  const int x1 = std::min(size_.width, (cell.x + 1) * kMotionCell);
  const int y1 = std::min(size_.height, (cell.y + 1) * kMotionCell);
  for (int y = cell.y * kMotionCell; y < y1; ++y)
    for (int x = cell.x * kMotionCell; x < x1; ++x) {
      if (!(now.w.row(y)[x] > 0)) continue;
      costs.back() += 1;
      const float light = *light_at(now, x, y);
      for (int k = 0; k < kLocal * kLocal; ++k) {
        const glm::ivec2 d = around + glm::ivec2(k % kLocal, k / kLocal) - kLocal / 2;
        // Beyond the search range, the margin's border is compared.
        const glm::ivec2 within = glm::clamp(d, -kMotionReach, kMotionReach);
        costs[static_cast<std::size_t>(k)] +=
            std::abs(light - *light_at(before, x - within.x, y - within.y));
      }
    }
}

glm::vec2 ClusterMotion::best_of_cell(Place cell, glm::ivec2 around, std::uint8_t label) const {
  std::array<float, kLocal * kLocal + 1> sum{};
  for (int y = std::max(0, cell.y - 1); y <= std::min(cells_.height - 1, cell.y + 1); ++y)
    for (int x = std::max(0, cell.x - 1); x <= std::min(cells_.width - 1, cell.x + 1); ++x)
      if (label_.row(y)[x] == label)
        for (std::size_t k = 0; k < sum.size(); ++k)
          sum[k] += costs_[static_cast<std::size_t>(y * cells_.width + x)][k];
  const auto cost = [&](int i, int j) { return sum[static_cast<std::size_t>(j * kLocal + i)]; };
  int best_i = kLocal / 2, best_j = kLocal / 2;
  float least = std::numeric_limits<float>::max();
  for (int j = 0; j < kLocal; ++j)
    for (int i = 0; i < kLocal; ++i) {
      const glm::ivec2 off = glm::ivec2(i, j) - kLocal / 2;
      const float bend = kBendCost * sum.back() * glm::length(glm::vec2(off));
      const float stays = around + off == glm::ivec2(0) ? kStays : 1.0F;
      const float total = stays * cost(i, j) + bend;
      if (total < least) least = total, best_i = i, best_j = j;
    }
  const glm::ivec2 whole = around + glm::ivec2(best_i, best_j) - kLocal / 2;
  if (whole == glm::ivec2(0)) return glm::vec2(0);
  glm::vec2 out(whole);
  if (best_i > 0 && best_i + 1 < kLocal)
    out.x +=
        least_between(cost(best_i - 1, best_j), cost(best_i, best_j), cost(best_i + 1, best_j));
  if (best_j > 0 && best_j + 1 < kLocal)
    out.y +=
        least_between(cost(best_i, best_j - 1), cost(best_i, best_j), cost(best_i, best_j + 1));
  return out;
}

void ClusterMotion::move_cluster(const PeopleSamples& now, const PeopleSamples& before,
                                 std::uint8_t label) {
  const glm::ivec2 around = best_of_cluster(now, before);
  for (const Place cell : cluster_) cost_of_cell(now, before, cell, around);
  for (const Place cell : cluster_) motion_.row(cell.y)[cell.x] = best_of_cell(cell, around, label);
}

/// Extends motion to cells beside people; between two people the nearer one counts.
void ClusterMotion::spread() {
  for (int y = 0; y < cells_.height; ++y)
    for (int x = 0; x < cells_.width; ++x) spread_.row(y)[x] = label_.row(y)[x] != 0;
  for (int ring = 0; ring < 2; ++ring) {
    next_spread_ = spread_;
    for (int y = 0; y < cells_.height; ++y)
      for (int x = 0; x < cells_.width; ++x) {
        if (spread_.row(y)[x]) continue;
        float nearest = 0;
        for (int j = std::max(0, y - 1); j <= std::min(cells_.height - 1, y + 1); ++j)
          for (int i = std::max(0, x - 1); i <= std::min(cells_.width - 1, x + 1); ++i) {
            if (!spread_.row(j)[i] || cell_w_.row(j)[i] <= nearest) continue;
            nearest = cell_w_.row(j)[i];
            motion_.row(y)[x] = motion_.row(j)[i];
          }
        if (!(nearest > 0)) continue;
        cell_w_.row(y)[x] = nearest;
        next_spread_.row(y)[x] = 1;
      }
    std::swap(spread_, next_spread_);
  }
}

bool follows_people(const CompositorSetup& setup) {
  return (setup.key.motion || setup.key.steady) && !setup.background.depth_m.empty() &&
         setup.background_models.empty() && !setup.lens_moves;
}

PeopleMotion::PeopleMotion(const Tables& tables)
    : tables_(tables),
      step_px_(std::max(1, (tables.view_size.width + kAcross / 2) / kAcross)),
      box_px_(static_cast<float>(step_px_ * tables.plate_size.width) /
              static_cast<float>(tables.view_size.width)),
      samples_{tables.view_size.width / step_px_, tables.view_size.height / step_px_},
      limit_w_(samples_),
      clusters_(samples_),
      motion_px_(clusters_.cells()) {
  plate_px_.reserve(samples_.area());
  for (int y = 0; y < samples_.height; ++y)
    for (int x = 0; x < samples_.width; ++x) {
      const int u = x * step_px_ + step_px_ / 2, v = y * step_px_ + step_px_ / 2;
      plate_px_.push_back(tables.plate_is_view ? glm::vec2(u, v) : tables.plate_px.row(v)[u]);
      limit_w_.row(y)[x] = std::abs(tables.key_limit_w.row(v)[u]);
    }
  const int tof_step =
      std::max(1, static_cast<int>(static_cast<float>(step_px_) / tables.tof_footprint_px));
  for (int y = 0; y < tables.tof_size.height; y += tof_step)
    for (int x = 0; x < tables.tof_size.width; x += tof_step) {
      const glm::vec3 ray(tables.tof_ray.row(y)[x], 1);
      if (!(ray.x == ray.x)) continue;
      rays_.push_back({x, y, tables.correct.depth_is_distance ? glm::normalize(ray) : ray});
    }
  const Size with_margin{samples_.width + 2 * kMotionReach, samples_.height + 2 * kMotionReach};
  for (PeopleSamples& s : seen_) s.light.reset(with_margin), s.w.reset(samples_);
}

bool PeopleMotion::see(const FrameInput& input, Crew& crew) {
  const double interval_s = input.time_s - time_s_;
  // The last frame again keeps its motion.
  if (any_ && interval_s == 0 && input.world_from_target == pose_) return false;
  const bool follows =
      any_ && interval_s > 0 && interval_s <= kPause_s && input.world_from_target == pose_;
  now_ = 1 - now_;
  sample_light(input.plate, crew);
  sample_people(input.tof_depth_m);
  known_ = follows;
  interval_s_ = interval_s;
  any_ = true, time_s_ = input.time_s, pose_ = input.world_from_target;
  if (!known_) return true;
  const auto& moved = clusters_.find(seen_[static_cast<std::size_t>(now_)],
                                     seen_[static_cast<std::size_t>(1 - now_)]);
  for (int y = 0; y < moved.height(); ++y)
    for (int x = 0; x < moved.width(); ++x)
      motion_px_.row(y)[x] = static_cast<float>(step_px_) * moved.row(y)[x];
  return true;
}

/// Means of points in the plate, for one row of samples.
void PeopleMotion::sample_light_row(ImageView<const Rgb8> plate, int y, float* light) const {
  const int last_x = plate.size.width - 1, last_y = plate.size.height - 1;
  const float apart = box_px_ / kMotionPoints;
  for (int x = 0; x < samples_.width; ++x) {
    const glm::vec2 at = plate_px_[static_cast<std::size_t>(y * samples_.width + x)] -
                         apart * (0.5F * (kMotionPoints - 1)) + 0.5F;
    std::array<int, kMotionPoints> columns;
    for (int i = 0; i < kMotionPoints; ++i)
      columns[static_cast<std::size_t>(i)] =
          std::clamp(static_cast<int>(at.x + apart * static_cast<float>(i)), 0, last_x);
    int sum = 0;
    for (int j = 0; j < kMotionPoints; ++j) {
      const Rgb8* in =
          plate.row(std::clamp(static_cast<int>(at.y + apart * static_cast<float>(j)), 0, last_y));
      for (const int column : columns) sum += in[column].r + 2 * in[column].g + in[column].b;
    }
    light[x] = static_cast<float>(sum) / (4 * kMotionPoints * kMotionPoints);
  }
}

/// Samples the plate; the margin repeats the border.
void PeopleMotion::sample_light(ImageView<const Rgb8> plate, Crew& crew) {
  constexpr int kGrain = 16;
  Image<float>& light = seen_[static_cast<std::size_t>(now_)].light;
  crew.rows(samples_.height, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      float* row = light.row(y + kMotionReach) + kMotionReach;
      sample_light_row(plate, y, row);
      std::fill(row - kMotionReach, row, row[0]);
      std::fill_n(row + samples_.width, kMotionReach, row[samples_.width - 1]);
    }
  });
  for (int k = 0; k < kMotionReach; ++k) {
    std::copy_n(light.row(kMotionReach), light.width(), light.row(k));
    std::copy_n(light.row(light.height() - kMotionReach - 1), light.width(),
                light.row(light.height() - 1 - k));
  }
}

/// Marks samples where the ToF camera measures something nearer than the key's limit. Raw values
/// do: single wrong ones do not fill a cell.
void PeopleMotion::sample_people(ImageView<const float> tof_depth_m) {
  Image<float>& people = seen_[static_cast<std::size_t>(now_)].w;
  people.fill(0);
  const PinholeParams& view = tables_.warp.view;
  const float per_px = 1 / static_cast<float>(step_px_);
  for (const Ray& ray : rays_) {
    const float d = tof_depth_m.row(ray.y)[ray.x];
    if (!(d > 0 && d < kFarthestM)) continue;
    const glm::vec3 q = transform(tables_.warp.camera_from_tof, ray.per_value * d);
    if (!(q.z > kNearestM)) continue;
    const float w = 1 / q.z;
    const glm::vec2 at = (view.focal_px * w * glm::vec2(q) + view.center_px + 0.5F) * per_px;
    if (!(at.x >= 0 && at.y >= 0)) continue;
    const int i = static_cast<int>(at.x), j = static_cast<int>(at.y);
    if (i >= samples_.width || j >= samples_.height || !(w > limit_w_.row(j)[i])) continue;
    people.row(j)[i] = std::max(people.row(j)[i], w);
  }
}

bool PeopleMotion::depth_shift_px(double depth_delay_s, Image<glm::vec2>& shift) const {
  if (!known_ || depth_delay_s == 0 || std::abs(depth_delay_s) > kPause_s) return false;
  const auto part = static_cast<float>(-depth_delay_s / interval_s_);
  bool any = false;
  for (int y = 0; y < shift.height(); ++y)
    for (int x = 0; x < shift.width(); ++x) {
      const glm::vec2 px = glm::round(part * motion_px_.row(y)[x]);
      shift.row(y)[x] = px;
      any |= px != glm::vec2(0);
    }
  return any;
}

}  // namespace mixrig::render
