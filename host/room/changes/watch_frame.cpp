// SPDX-License-Identifier: Apache-2.0
#include "host/room/changes/watch_frame.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::model {
namespace {

/// Two surfaces differ by this many sigmas and this much at least: systematic errors of depth,
/// which differ between the views of the scan and this one.
constexpr double kChangeSigmas = 5, kLeastStep_m = 0.07;
/// Least number of the four pairs of opposite neighbours that must lie on a pixel's surface.
constexpr int kFewestPairs = 3;
/// Least number of the 9 model pixels around one that must lie on its surface: more than a line
/// has.
constexpr int kFewestOfModel = 5;

}  // namespace

void FrameSight::see(const WatchFrame& frame) {
  frame_ = frame;
  view_from_world_ = geometry::inverse(frame.world_from_view);
  turn_ = view_from_world_.rotation.toRotationMatrix();
  for (Image<float>* image :
       {&steady_m_, &near_m_, &far_m_, &shared_m_, &seen_near_m_, &row_near_m_, &row_far_m_})
    if (image->size() != frame.view.size_px) image->reset(frame.view.size_px);
  spread_model();
  spread_seen();
  find_steady();
}

float FrameSight::step_m(float z_m) const {
  return static_cast<float>(
      std::max(kLeastStep_m, kChangeSigmas * noise_.sigma_m(static_cast<double>(z_m))));
}

void FrameSight::spread_model() {
  const int w = width(), h = height();
  for (int y = 0; y < h; ++y) {
    const float* z = frame_.model_depth_m.row(y);
    for (int x = 0; x < w; ++x) {
      const int first = std::max(0, x - kReach_px), last = std::min(w - 1, x + kReach_px);
      const auto [near, far] = std::minmax_element(z + first, z + last + 1);
      row_near_m_.row(y)[x] = *near, row_far_m_.row(y)[x] = *far;
    }
  }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      float near = row_near_m_.row(y)[x], far = row_far_m_.row(y)[x];
      for (int j = std::max(0, y - kReach_px); j <= std::min(h - 1, y + kReach_px); ++j) {
        near = std::min(near, row_near_m_.row(j)[x]);
        far = std::max(far, row_far_m_.row(j)[x]);
      }
      near_m_.row(y)[x] = near, far_m_.row(y)[x] = far;
    }
}

/// Measured z of a pixel with a neighbour on its surface, else kNoDepth_m.
float FrameSight::shared_m(int x, int y) const {
  const float z = frame_.depth_m.row(y)[x];
  if (!(z > 0)) return kNoDepth_m;
  const float step = step_m(z);
  int count = 0;
  for (int j = std::max(0, y - 1); j <= std::min(height() - 1, y + 1); ++j)
    for (int i = std::max(0, x - 1); i <= std::min(width() - 1, x + 1); ++i)
      count += std::abs(frame_.depth_m.row(j)[i] - z) < step ? 1 : 0;
  return count > 1 ? z : kNoDepth_m;
}

void FrameSight::spread_seen() {
  const int w = width(), h = height();
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) shared_m_.row(y)[x] = shared_m(x, y);
  for (int y = 0; y < h; ++y) {
    const float* z = shared_m_.row(y);
    for (int x = 0; x < w; ++x) {
      const int first = std::max(0, x - kReach_px), last = std::min(w - 1, x + kReach_px);
      row_near_m_.row(y)[x] = *std::min_element(z + first, z + last + 1);
    }
  }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      float near = kNoDepth_m;
      for (int j = std::max(0, y - kReach_px); j <= std::min(h - 1, y + kReach_px); ++j)
        near = std::min(near, row_near_m_.row(j)[x]);
      seen_near_m_.row(y)[x] = near;
    }
}

/// On a plane inverse depth is linear in the picture: the mean of two opposite neighbours is that
/// of the pixel. Such pairs are summed up, with how many there are.
int FrameSight::add_pairs(int x, int y, float& sum_w) const {
  constexpr std::array<std::array<int, 2>, 4> kAxes{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  const float z = frame_.depth_m.row(y)[x], step = step_m(z);
  int count = 0;
  for (const auto& [dx, dy] : kAxes) {
    const float a = frame_.depth_m.row(y - dy)[x - dx], b = frame_.depth_m.row(y + dy)[x + dx];
    if (!(a > 0 && b > 0)) continue;
    const float pair_w = 1 / a + 1 / b;
    if (!(std::abs(2 / pair_w - z) < 0.5F * step)) continue;
    sum_w += pair_w;
    ++count;
  }
  return count;
}

void FrameSight::find_steady() {
  steady_m_.fill(0);
  for (int y = 1; y < height() - 1; ++y)
    for (int x = 1; x < width() - 1; ++x) {
      const float z = frame_.depth_m.row(y)[x];
      float sum_w = 0;
      if (z > 0 && add_pairs(x, y, sum_w) >= kFewestPairs) steady_m_.row(y)[x] = z;
    }
}

float FrameSight::mean_m(int x, int y) const {
  const float z = steady_m_.row(y)[x];
  if (!(z > 0)) return 0;
  float sum_w = 1 / z;
  const int pairs = add_pairs(x, y, sum_w);
  return static_cast<float>(1 + 2 * pairs) / sum_w;
}

FrameSight::Beside FrameSight::compare(int x, int y) const {
  const float z = steady_m_.row(y)[x], near = near_m_.row(y)[x], far = far_m_.row(y)[x];
  if (!(z > 0) || !(near > 0)) return Beside::kNothing;
  if (z < near - step_m(near)) return Beside::kNearer;
  const float step = 0.5F * step_m(z);
  return z > near - step && z < far + step ? Beside::kSame : Beside::kNothing;
}

bool FrameSight::is_seen_through(int x, int y) const {
  const float m = frame_.model_depth_m.row(y)[x];
  if (!(m > 0 && steady_m(x, y) > 0 && nearest_m(x, y) > m + step_m(m))) return false;
  int count = 0;
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i)
      count += std::abs(frame_.model_depth_m.row(j)[i] - m) < step_m(m) ? 1 : 0;
  return count >= kFewestOfModel;
}

Eigen::Vector3d FrameSight::world(int x, int y, float z_m) const {
  const Eigen::Vector2d ray = frame_.view.unproject({x, y});
  return frame_.world_from_view * (Eigen::Vector3d(ray.x(), ray.y(), 1) * double{z_m});
}

bool FrameSight::find(const Eigen::Vector3d& world_m, int& x, int& y, float& z_m) const {
  const Eigen::Vector3d p = turn_ * world_m + view_from_world_.translation_m;
  if (!(p.z() > 0.05)) return false;
  const Eigen::Vector2d px = frame_.view.project(p);
  if (!(px.x() > -0.5 && px.y() > -0.5 && px.x() < width() - 0.5 && px.y() < height() - 0.5))
    return false;
  x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
  z_m = static_cast<float>(p.z());
  return true;
}

}  // namespace mixrig::model
