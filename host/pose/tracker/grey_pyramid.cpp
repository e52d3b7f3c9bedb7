// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/grey_pyramid.h"

#include <algorithm>

namespace mixrig::tracking {
namespace {

constexpr int kGreyGrain = 32, kLeastSide_px = 16;

void luma(ImageView<const Rgb8> from, Image<float>& to, int y) {
  const Rgb8* in = from.row(y);
  float* out = to.row(y);
  for (int x = 0; x < to.width(); ++x)
    out[x] = 0.299F * static_cast<float>(in[x].r) + 0.587F * static_cast<float>(in[x].g) +
             0.114F * static_cast<float>(in[x].b);
}

void halve(const Image<float>& from, Image<float>& to, int y) {
  const float *upper = from.row(2 * y), *lower = from.row(2 * y + 1);
  float* out = to.row(y);
  for (int x = 0; x < to.width(); ++x)
    out[x] = 0.25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
}

}  // namespace

void GreyPyramid::build(ImageView<const Rgb8> picture, int levels, Crew& crew) {
  int count = 1;
  while (count < levels &&
         std::min(picture.size.width, picture.size.height) >> count >= kLeastSide_px)
    ++count;
  levels_.resize(static_cast<std::size_t>(count));
  if (levels_[0].size() != picture.size) levels_[0].reset(picture.size);
  crew.rows(picture.size.height, kGreyGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) luma(picture, levels_[0], y);
  });
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Image<float>& from = levels_[k - 1];
    const Size size{from.width() / 2, from.height() / 2};
    if (levels_[k].size() != size) levels_[k].reset(size);
    crew.rows(size.height, kGreyGrain, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) halve(from, levels_[k], y);
    });
  }
}

}  // namespace mixrig::tracking
