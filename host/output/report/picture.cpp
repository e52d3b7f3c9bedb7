// SPDX-License-Identifier: Apache-2.0
#include "host/output/report/picture.h"

#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hal/base/order_statistics.h"
#include "hal/base/srgb.h"
#include "host/output/report/canvas.h"
#include "host/render/contract/compositor.h"

namespace mixrig::report {
namespace {

std::uint8_t to_byte(float v) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255.0F));
}

bool known(float z_m) { return std::isfinite(z_m) && z_m > 0.0F; }

template <typename In, typename PixelOf>
Image<Rgb8> mapped(ImageView<const In> in, PixelOf&& pixel_of) {
  Image<Rgb8> out(in.size);
  for (int y = 0; y < in.size.height; ++y)
    for (int x = 0; x < in.size.width; ++x) out.row(y)[x] = pixel_of(in.row(y)[x]);
  return out;
}

}  // namespace

/// Red, yellow, green, cyan, blue, violet, interpolated linearly.
Rgb8 depth_color(float share) {
  constexpr std::array<Rgbf, 6> kStops{{{0.85F, 0.15F, 0.1F},
                                        {0.95F, 0.8F, 0.2F},
                                        {0.3F, 0.8F, 0.3F},
                                        {0.2F, 0.75F, 0.8F},
                                        {0.2F, 0.3F, 0.85F},
                                        {0.35F, 0.1F, 0.5F}}};
  const float at = std::clamp(share, 0.0F, 1.0F) * (kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const float part = at - static_cast<float>(i);
  const auto mix = [&](float a, float b) { return to_byte(a + part * (b - a)); };
  return {mix(kStops[i].r, kStops[i + 1].r), mix(kStops[i].g, kStops[i + 1].g),
          mix(kStops[i].b, kStops[i + 1].b)};
}

Image<Rgb8> depth_picture(ImageView<const float> depth_m, float near_m, float far_m) {
  const float scale = 1.0F / std::max(far_m - near_m, 1e-3F);
  return mapped(depth_m,
                [&](float z) { return known(z) ? depth_color((z - near_m) * scale) : Rgb8{}; });
}

Rgb8 error_color(float share) {
  if (!(share >= 0)) return {};
  const float t = std::sqrt(std::min(share, 1.0F));
  return {to_byte(1 - 0.2F * t * t), to_byte(1 - 0.85F * t), to_byte(1 - 1.6F * t)};
}

Image<Rgb8> error_picture(ImageView<const float> error, float most, const std::string& unit) {
  constexpr int kScale_px = 44, kBar_px = 256;
  Canvas canvas({error.size.width, error.size.height + kScale_px}, {255, 255, 255});
  canvas.picture(0, 0, mapped(error, [&](float e) { return error_color(e / most); }));
  Image<Rgb8> bar({kBar_px, 12});
  for (int y = 0; y < bar.height(); ++y)
    for (int x = 0; x < kBar_px; ++x)
      bar.row(y)[x] = error_color(static_cast<float>(x) / (kBar_px - 1));
  const int left = 16, top = error.size.height + 8;
  canvas.picture(left, top, bar);
  for (const double share : {0.0, 0.25, 1.0})
    canvas.text(
        {left + share * kBar_px, top + 28.0},
        fmt::format("{:g}{}", share * static_cast<double>(most), share < 1 ? "" : " " + unit), 12,
        {40, 40, 40});
  return canvas.finish();
}

std::pair<float, float> depth_range(ImageView<const float> depth_m) {
  std::vector<float> values;
  for (int y = 0; y < depth_m.size.height; y += 2)
    for (int x = 0; x < depth_m.size.width; x += 2)
      if (const float z = depth_m.row(y)[x]; known(z)) values.push_back(z);
  if (values.empty()) return {0.0F, 1.0F};
  const std::size_t margin = values.size() / 100;
  const float low = order_statistic(std::span(values), margin);
  return {low, order_statistic(std::span(values), values.size() - 1 - margin)};
}

Rgb8 key_color(std::uint8_t state) {
  switch (static_cast<render::PixelState>(state)) {
    case render::PixelState::kForeground:
      return {255, 255, 255};
    case render::PixelState::kEdge:
      return {250, 200, 60};
    case render::PixelState::kBackground:
      return {40, 70, 130};
    case render::PixelState::kUnknown:
      break;
  }
  return {40, 40, 40};
}

Image<Rgb8> key_picture(ImageView<const std::uint8_t> state) { return mapped(state, key_color); }

Image<Rgb8> light_picture(ImageView<const float> light) {
  return mapped(light, [](float l) {
    const std::uint8_t grey = to_byte(srgb_from_linear(l));
    return Rgb8{grey, grey, grey};
  });
}

Image<Rgb8> shrunk(ImageView<const Rgb8> picture, Size size) {
  Image<Rgb8> out(size);
  const auto band = [](int i, int n, int of) {
    const int begin = static_cast<int>(static_cast<std::int64_t>(i) * of / n);
    const int end = static_cast<int>(static_cast<std::int64_t>(i + 1) * of / n);
    return std::pair{begin, std::max(end, begin + 1)};
  };
  for (int y = 0; y < size.height; ++y) {
    const auto [v0, v1] = band(y, size.height, picture.size.height);
    for (int x = 0; x < size.width; ++x) {
      const auto [u0, u1] = band(x, size.width, picture.size.width);
      int r = 0, g = 0, b = 0;
      for (int v = v0; v < v1; ++v) {
        for (int u = u0; u < u1; ++u) {
          const Rgb8 p = picture.row(v)[u];
          r += p.r, g += p.g, b += p.b;
        }
      }
      const int n = (v1 - v0) * (u1 - u0);
      out.row(y)[x] = {static_cast<std::uint8_t>(r / n), static_cast<std::uint8_t>(g / n),
                       static_cast<std::uint8_t>(b / n)};
    }
  }
  return out;
}

}  // namespace mixrig::report
