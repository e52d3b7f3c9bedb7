// SPDX-License-Identifier: Apache-2.0
// Learning a background: robust centre and spread of each pixel over empty frames.
#include "host/room/background/static_background.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "hal/base/order_statistics.h"
#include "hal/base/parallel.h"
#include "hal/base/srgb.h"
#include "host/room/background/room_surface.h"

namespace mixrig::model {
namespace {

constexpr float kStep_m = 0.00025F;  ///< of a kept depth; 65535 of them reach 16.4 m
constexpr int kFewestFrames = 3;
/// A value is known to within its step: sigma of a uniform distribution is step / sqrt 12.
constexpr float kLeastDepthSigma_m = kStep_m * 0.288675F;
constexpr float kLeastColorSigma = 0.288675F / 255.0F;
/// Standard deviation of a normal distribution in units of its median absolute deviation.
constexpr float kSigmaPerMad = 1.4826F;

struct Spread {
  float center, sigma;
};

/// Median and scaled median absolute deviation. Overwrites the values.
Spread robust_spread(std::span<float> values) {
  const float center = median_in_place(values);
  for (float& value : values) value = std::abs(value - center);
  return {center, kSigmaPerMad * median_in_place(values)};
}

/// Whether something stood before the room in several of the frames that measured a pixel.
bool is_covered(const RoomSurface& room, int measured) {
  constexpr int kSeldom = 20;  // one frame in so many is chance, at a border of depth
  return room.nearer >= 2 && kSeldom * room.nearer > measured;
}

std::uint16_t to_steps(float depth_m) {
  const float steps = std::round(depth_m / kStep_m);
  return steps >= 1.0F && steps <= 65535.0F ? static_cast<std::uint16_t>(steps) : std::uint16_t{0};
}

/// Frame i of those added is kept where this divides i: the smallest power of two that leaves at
/// most `max_frames` of the first `added`.
int stride_of(int added, int max_frames) {
  int stride = 1;
  while ((added - 1) / stride >= max_frames) stride *= 2;
  return stride;
}

template <typename T>
void drop_odd(std::vector<T>& frames) {
  std::vector<T> even;
  for (std::size_t i = 0; i < frames.size(); i += 2) even.push_back(std::move(frames[i]));
  frames = std::move(even);
}

/// A part of a picture: columns [x0, x1) of the rows [y0, y1).
struct Bounds {
  int x0, y0, x1, y1;
};

/// Bounding box of all known depths, at least one pixel large.
Bounds bounds_of_known(ImageView<const float> depth_m) {
  Bounds b{depth_m.size.width, depth_m.size.height, 0, 0};
  const auto known = [](float z) { return z > 0; };
  for (int y = 0; y < depth_m.size.height; ++y) {
    const float *row = depth_m.row(y), *end = row + depth_m.size.width;
    const float* const first = std::find_if(row, end, known);
    if (first == end) continue;
    while (!known(end[-1])) --end;
    b = {std::min(b.x0, static_cast<int>(first - row)), std::min(b.y0, y),
         std::max(b.x1, static_cast<int>(end - row)), y + 1};
  }
  return b.x1 > b.x0 ? b : Bounds{0, 0, 1, 1};
}

}  // namespace

StaticBackgroundBuilder::StaticBackgroundBuilder(const geometry::Pinhole& view, int max_frames,
                                                 Views views)
    : view_(view), max_frames_(std::max(max_frames, kFewestFrames)), views_(views) {}

Result<void> StaticBackgroundBuilder::add(ImageView<const float> depth_m,
                                          ImageView<const Rgb8> color) {
  if (depth_m.size != view_.size_px || color.size != view_.size_px)
    return Error{ErrorCode::kData, "a frame for the background has another size than the view"};
  const int index = seen_++;
  const int stride = stride_of(seen_, max_frames_);
  const std::size_t older = static_cast<std::size_t>((index + stride - 1) / stride);
  if (kept_.size() > older) drop_odd(kept_);
  if (index % stride != 0) return {};
  const Bounds b = views_ == Views::kDifferent
                       ? bounds_of_known(depth_m)
                       : Bounds{0, 0, view_.size_px.width, view_.size_px.height};
  const Size size{b.x1 - b.x0, b.y1 - b.y0};
  Kept& kept = kept_.emplace_back(Kept{b.x0, b.y0, Image<std::uint16_t>(size), Image<Rgb8>(size)});
  for (int y = 0; y < size.height; ++y) {
    const float* const from_m = depth_m.row(b.y0 + y) + b.x0;
    std::transform(from_m, from_m + size.width, kept.depth.row(y), to_steps);
    std::copy_n(color.row(b.y0 + y) + b.x0, size.width, kept.color.row(y));
  }
  return {};
}

Result<StaticBackground> StaticBackgroundBuilder::finish() {
  const int frames = static_cast<int>(kept_.size());
  if (frames < kFewestFrames)
    return Error{ErrorCode::kData, "a background needs at least 3 empty frames, not " +
                                       std::to_string(frames) + ": give more frames"};
  StaticBackground out;
  out.view = view_;
  out.frames = frames;
  out.depth_m.reset(view_.size_px);
  out.depth_sigma_m.reset(view_.size_px);
  out.color.reset(view_.size_px);
  out.color_sigma.reset(view_.size_px);
  const bool moving = views_ == Views::kDifferent;
  std::atomic<int> covered = 0, unseen = 0;
  const auto learn_depth = [&](int x, int y, std::vector<float>& values) -> RoomSurface {
    values.clear();
    for (const Kept& frame : kept_) {
      if (!frame.has(x, y)) continue;
      const std::uint16_t steps = frame.depth.row(y - frame.y0)[x - frame.x0];
      if (steps != 0) values.push_back(kStep_m * steps);
    }
    const int count = static_cast<int>(values.size());
    const auto is_known = [&](int of, int among) {
      return moving ? of >= kFewestFrames : 3 * of >= among;
    };
    RoomSurface room = room_surface(values);
    covered += is_covered(room, count);
    if (count == 0 || !is_known(room.count, frames - room.nearer)) {
      unseen += count > 0 && is_known(count, frames);
      return {};
    }
    std::erase_if(values, [&](float z_m) { return !room.has(z_m); });
    const Spread z = robust_spread(values);
    out.depth_m.row(y)[x] = z.center;
    out.depth_sigma_m.row(y)[x] = std::max(z.sigma, kLeastDepthSigma_m);
    return room;
  };
  const auto& linear = linear_of_srgb_bytes();
  const auto learn_channel = [&](int x, int y, const RoomSurface& room, std::uint8_t Rgb8::*channel,
                                 std::vector<float>& values) {
    // Where the room has no depth, what has one stands before it.
    const auto add_where = [&](const auto& is_of_room) {
      values.clear();
      for (const Kept& frame : kept_) {
        if (!frame.has(x, y)) continue;
        const int row = y - frame.y0, column = x - frame.x0;
        if (is_of_room(frame.depth.row(row)[column]))
          values.push_back(linear[frame.color.row(row)[column].*channel]);
      }
      return static_cast<int>(values.size()) >= kFewestFrames;
    };
    if (room.count > 0)
      add_where([&](std::uint16_t steps) { return steps != 0 && room.has(kStep_m * steps); });
    else if (!add_where([](std::uint16_t steps) { return steps == 0; }))
      add_where([](std::uint16_t) { return true; });
    return robust_spread(values);
  };
  Crew crew;
  crew.rows(view_.size_px.height, 16, [&](int begin, int end) {
    std::vector<float> values;
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < view_.size_px.width; ++x) {
        const RoomSurface room = learn_depth(x, y, values);
        if (moving && !(out.depth_m.row(y)[x] > 0)) {
          out.color.row(y)[x] = {-1, -1, -1};
          continue;
        }
        const Spread r = learn_channel(x, y, room, &Rgb8::r, values),
                     g = learn_channel(x, y, room, &Rgb8::g, values),
                     b = learn_channel(x, y, room, &Rgb8::b, values);
        out.color.row(y)[x] = {r.center, g.center, b.center};
        out.color_sigma.row(y)[x] =
            std::max((r.sigma + g.sigma + b.sigma) / 3.0F, kLeastColorSigma);
      }
  });
  out.covered_share = static_cast<double>(covered) / static_cast<double>(view_.size_px.area());
  out.unseen_share = static_cast<double>(unseen) / static_cast<double>(view_.size_px.area());
  kept_ = {};
  seen_ = 0;
  const auto row_has_depth = [&](int y) {
    const float* row = out.depth_m.row(y);
    return std::any_of(row, row + out.depth_m.width(), [](float z) { return z > 0; });
  };
  bool known = false;
  for (int y = 0; y < out.depth_m.height() && !known; ++y) known = row_has_depth(y);
  if (!known)
    return Error{
        ErrorCode::kData,
        "no pixel of the background has a known depth: check the depth stream and its unit"};
  out.floor = find_floor(view_, out.depth_m);
  return out;
}

}  // namespace mixrig::model
