// SPDX-License-Identifier: Apache-2.0
#include "host/room/changes/light_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/base/order_statistics.h"
#include "hal/base/srgb.h"

namespace mixrig::model {
namespace {

/// Range of bytes from which a channel's light is known, and least linear colour of the model to
/// compare with.
constexpr int kDarkestByte = 8, kBrightestByte = 250;
constexpr float kDarkestModel = 0.01F;
constexpr int kFewestSamples = 4;
/// Time over which the colour of a patch is averaged, and for which it counts.
constexpr double kMean_s = 1, kRecent_s = 1.5;

}  // namespace

LightWatch::LightWatch(const Eigen::AlignedBox3d& room_m)
    : origin_m_(room_m.min()), patch_m_(kLeastPatch_m) {
  const Eigen::Array3d extent_m = room_m.sizes().array() + 1e-3;
  patch_m_ = std::max(patch_m_, std::cbrt(extent_m.prod() / kMostPatches));
  size_ = (extent_m / patch_m_).ceil().cast<int>().max(1);
  const auto count = static_cast<std::size_t>(size_.prod());
  patches_.resize(count);
  for (auto* list : {&touched_, &recent_}) list->reserve(count);
  values_.reserve(count);
}

Eigen::Vector3d LightWatch::center_m(std::size_t patch) const {
  const auto index = static_cast<int>(patch);
  const Eigen::Array3d at(index % size_.x(), index / size_.x() % size_.y(),
                          index / (size_.x() * size_.y()));
  return origin_m_.array() + (at + 0.5) * patch_m_;
}

void LightWatch::forget() {
  std::fill(patches_.begin(), patches_.end(), Patch{});
  state_ = {};
}

void LightWatch::add(const FrameSight& sight, double dt_s) {
  if (sight.frame().model_color.empty()) return;
  sum_up(sight);
  take_in(sight.frame().time_s, dt_s);
  find_state(sight.frame().time_s);
  const Eigen::Array3d common = state_.factor.log();
  for (const std::size_t i : touched_) {
    Patch& patch = patches_[i];
    const double off = (patch.log_factor - common).abs().maxCoeff();
    patch.off_s = off > std::log(kOwnColor) ? patch.off_s + dt_s : 0;
  }
}

void LightWatch::sum_up(const FrameSight& sight) {
  touched_.clear();
  const auto& linear = linear_of_srgb_bytes();
  const WatchFrame& frame = sight.frame();
  for (int y = 0; y < sight.height(); ++y)
    for (int x = 0; x < sight.width(); ++x) {
      const Rgbf m = frame.model_color.row(y)[x];
      if (!(std::min({m.r, m.g, m.b}) > kDarkestModel)) continue;
      const Rgb8 c = frame.color.row(y)[x];
      const auto [least, most] = std::minmax({c.r, c.g, c.b});
      if (least < kDarkestByte || most > kBrightestByte) continue;
      if (sight.compare(x, y) != FrameSight::Beside::kSame) continue;
      const Eigen::Array3d at =
          (sight.world(x, y, sight.steady_m(x, y)) - origin_m_).array() / patch_m_;
      if (!(at >= 0).all() || !(at < size_.cast<double>()).all()) continue;
      const Eigen::Array3i p = at.cast<int>();
      const auto index = static_cast<std::size_t>((p.z() * size_.y() + p.y()) * size_.x() + p.x());
      Patch& patch = patches_[index];
      if (patch.samples++ == 0) {
        touched_.push_back(index);
        patch.sum_seen = patch.sum_model = Eigen::Array3d::Zero();
      }
      patch.sum_seen += Eigen::Array3d(linear[c.r], linear[c.g], linear[c.b]);
      patch.sum_model += Eigen::Array3d(m.r, m.g, m.b);
    }
}

void LightWatch::take_in(double time_s, double dt_s) {
  std::size_t kept = 0;
  for (const std::size_t i : touched_) {
    Patch& patch = patches_[i];
    const bool enough = std::exchange(patch.samples, 0) >= kFewestSamples;
    if (!enough) continue;
    const Eigen::Array3d now = (patch.sum_seen / patch.sum_model).log();
    const bool fresh = patch.seen_s < 0 || time_s - patch.seen_s > kRecent_s;
    if (fresh) patch.first_s = time_s, patch.off_s = 0;
    const double share = fresh ? 1 : std::min(dt_s / kMean_s, 1.0);
    patch.log_factor =
        fresh ? now : Eigen::Array3d(patch.log_factor + share * (now - patch.log_factor));
    patch.seen_s = time_s;
    touched_[kept++] = i;
  }
  touched_.resize(kept);
}

void LightWatch::find_state(double time_s) {
  recent_.clear();
  for (std::size_t i = 0; i < patches_.size(); ++i)
    if (patches_[i].seen_s >= 0 && time_s - patches_[i].seen_s <= kRecent_s) recent_.push_back(i);
  state_ = {};
  state_.patches = static_cast<int>(recent_.size());
  if (recent_.empty()) return;
  Eigen::Array3d median;
  for (int channel = 0; channel < 3; ++channel) {
    values_.clear();
    for (const std::size_t i : recent_) values_.push_back(patches_[i].log_factor[channel]);
    median[channel] = upper_median_in_place(std::span(values_));
  }
  const auto uneven = std::count_if(recent_.begin(), recent_.end(), [&](std::size_t i) {
    return (patches_[i].log_factor - median).abs().maxCoeff() > std::log(kUneven);
  });
  state_.factor = median.exp();
  state_.uneven_share = static_cast<double>(uneven) / static_cast<double>(recent_.size());
}

}  // namespace mixrig::model
