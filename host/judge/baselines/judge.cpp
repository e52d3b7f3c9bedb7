// SPDX-License-Identifier: Apache-2.0
#include "host/judge/baselines/judge.h"

#include <cmath>

namespace mixrig::session {
namespace {

static_assert(measure::kLayerMask == capture::Truth::kLayerMask &&
              measure::kTofSees == capture::Truth::kTofSees &&
              measure::kInSilhouette == capture::Truth::kVirtual);
static_assert(measure::kLayerVirtual == static_cast<int>(render::Layer::kVirtual));

/// Source coordinate of a pixel centre when `from` pixels become `to`.
float source_px(int i, int from, int to) {
  const float at =
      (static_cast<float>(i) + 0.5F) * static_cast<float>(from) / static_cast<float>(to) - 0.5F;
  return std::clamp(at, 0.0F, static_cast<float>(from - 1));
}

template <typename T>
Image<T> nearest(ImageView<const T> in, Size size) {
  Image<T> out(size);
  for (int y = 0; y < size.height; ++y) {
    const T* row = in.row(static_cast<int>(std::lround(source_px(y, in.size.height, size.height))));
    for (int x = 0; x < size.width; ++x)
      out.row(y)[x] = row[std::lround(source_px(x, in.size.width, size.width))];
  }
  return out;
}

float mix(float a, float b, float t) { return a + t * (b - a); }
std::uint8_t mix(std::uint8_t a, std::uint8_t b, float t) {
  return static_cast<std::uint8_t>(
      std::lround(mix(static_cast<float>(a), static_cast<float>(b), t)));
}
Rgb8 mix(Rgb8 a, Rgb8 b, float t) { return {mix(a.r, b.r, t), mix(a.g, b.g, t), mix(a.b, b.b, t)}; }

template <typename T>
Image<T> bilinear(ImageView<const T> in, Size size) {
  Image<T> out(size);
  for (int y = 0; y < size.height; ++y) {
    const float v = source_px(y, in.size.height, size.height);
    const int y0 = static_cast<int>(v), y1 = std::min(y0 + 1, in.size.height - 1);
    for (int x = 0; x < size.width; ++x) {
      const float u = source_px(x, in.size.width, size.width);
      const int x0 = static_cast<int>(u), x1 = std::min(x0 + 1, in.size.width - 1);
      const float tx = u - static_cast<float>(x0);
      out.row(y)[x] = mix(mix(in.row(y0)[x0], in.row(y0)[x1], tx),
                          mix(in.row(y1)[x0], in.row(y1)[x1], tx), v - static_cast<float>(y0));
    }
  }
  return out;
}

}  // namespace

measure::Errors Judge::errors() const {
  measure::Errors errors = measure::errors_of(sums_);
  errors.matte_flicker = flicker_.still();
  errors.matte_dtssd = flicker_.all();
  errors.scraps = measure::scraps_of(scraps_.sums());
  errors.stairs = {real_stairs_.off_line_px.mean(), virtual_stairs_.off_line_px.mean(),
                   real_stairs_.width_px.mean(), virtual_stairs_.width_px.mean()};
  if (room_shown_) errors.look = measure::look_of(look_);
  if (!room_shown_) {
    errors.light_rmse = errors.light_shadow_rmse = errors.color_psnr_db = {};
    errors.object_rmse = errors.object_psnr_db = {};
    errors.contested.light_rmse = errors.contested.color_psnr_db = {};
  }
  return errors;
}

Result<void> Judge::add(const capture::Truth& truth, const render::FrameOutput& output) {
  return add(truth, measure::ResultImages{output.color, output.warped_depth_m, output.matte,
                                          output.light, output.layer, output.mixed_depth_m});
}

Result<void> Judge::add(const capture::Truth& frame_truth, const measure::ResultImages& in) {
  const measure::TruthImages truth{frame_truth.composite, frame_truth.depth_m, frame_truth.matte,
                                   frame_truth.light, frame_truth.labels};
  const Size size = frame_truth.labels.size();
  if (size == in.color.size) return add_in_size(in, truth);
  const Image<Rgb8> color = bilinear(in.color, size);
  const Image<float> depth_m = nearest(in.warped_depth_m, size);
  const Image<std::uint8_t> matte = bilinear(in.matte, size);
  const Image<float> light = bilinear(in.light, size);
  const Image<std::uint8_t> layer = nearest(in.layer, size);
  const Image<float> mixed_m =
      in.mixed_depth_m.size.empty() ? Image<float>() : nearest(in.mixed_depth_m, size);
  return add_in_size({color, depth_m, matte, light, layer, mixed_m}, truth);
}

Result<void> Judge::add_in_size(measure::ResultImages result, const measure::TruthImages& truth) {
  if (room_shown_) return add_judged(result, truth);
  // The truth knows the objects and not the set around them.
  own_layer_.reset(result.layer.size);
  for (int y = 0; y < result.layer.size.height; ++y)
    for (int x = 0; x < result.layer.size.width; ++x)
      if ((truth.labels.row(y)[x] & measure::kInSilhouette) != 0)
        own_layer_.row(y)[x] = result.layer.row(y)[x];
  result.layer = own_layer_;
  return add_judged(result, truth);
}

Result<void> Judge::add_judged(const measure::ResultImages& result,
                               const measure::TruthImages& truth) {
  MIXRIG_TRY(measure::add_frame(result, truth, sums_));
  flicker_.add(result.matte, truth.matte);
  scraps_.add(result.layer, result.matte, truth);
  if (!room_shown_) return {};
  measure::add_look(result, truth, look_);
  measure::add_stairs(result.color, truth.labels, measure::kLayerPerson, real_stairs_);
  measure::add_stairs(result.color, truth.labels, measure::kLayerVirtual, virtual_stairs_);
  return {};
}

}  // namespace mixrig::session
