// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/marks.h"

#include <algorithm>
#include <cstdlib>

#include "host/capture/capture/bracket.h"

namespace mixrig::viewfinder {
namespace {

constexpr int kStripe_px = 4;
constexpr Rgbx8 kBlack{0, 0, 0, 255}, kPeak{255, 30, 30, 255};
constexpr Rgbx8 kEmpty{36, 36, 40, 255}, kEmptyLine{90, 90, 96, 255};

int brightness(Rgbx8 p) { return (77 * p.r + 150 * p.g + 29 * p.b) >> 8; }

bool saturated(Rgbx8 p) { return std::max({p.r, p.g, p.b}) >= capture::kSaturatedByte; }

std::uint8_t half(int byte) { return static_cast<std::uint8_t>(byte / 2); }

void half_white(Rgbx8& p) {
  p = {half(p.r + 255), half(p.g + 255), half(p.b + 255), half(p.x + 255)};
}

void level_line(ImageView<Rgbx8> picture, int x0, int x1, int y) {
  for (int x = x0; x < x1; ++x) half_white(picture.row(y)[x]);
}

void upright_line(ImageView<Rgbx8> picture, int x, int y0, int y1) {
  for (int y = y0; y < y1; ++y) half_white(picture.row(y)[x]);
}

/// The border of the middle `percent` of the picture; corners are drawn once.
void draw_inner(ImageView<Rgbx8> picture, int percent) {
  const int w = picture.size.width, h = picture.size.height;
  const int left = w * (100 - percent) / 200, top = h * (100 - percent) / 200;
  level_line(picture, left, w - left, top);
  level_line(picture, left, w - left, h - 1 - top);
  upright_line(picture, left, top + 1, h - 1 - top);
  upright_line(picture, w - 1 - left, top + 1, h - 1 - top);
}

}  // namespace

void mark_exposure_and_focus(ImageView<Rgbx8> picture, bool zebra, bool peaking) {
  if (!zebra && !peaking) return;
  const int w = picture.size.width, h = picture.size.height;
  for (int y = 0; y < h; ++y) {
    // A pixel is compared with those that come after it, which are not marked yet.
    Rgbx8* const row = picture.row(y);
    const Rgbx8* const below = picture.row(std::min(y + 1, h - 1));
    for (int x = 0; x < w; ++x) {
      const Rgbx8 here = row[x];
      const int light = peaking ? brightness(here) : 0;
      if (peaking && std::abs(brightness(row[std::min(x + 1, w - 1)]) - light) +
                             std::abs(brightness(y + 1 < h ? below[x] : here) - light) >=
                         kPeakStep)
        row[x] = kPeak;
      else if (zebra && saturated(here) && (x + y) / kStripe_px % 2 == 0)
        row[x] = kBlack;
    }
  }
}

void draw_guides(ImageView<Rgbx8> picture) {
  const int w = picture.size.width, h = picture.size.height;
  if (w < 20 || h < 20) return;
  for (const int third : {1, 2}) {
    level_line(picture, 0, w, h * third / 3);
    upright_line(picture, w * third / 3, 0, h);
  }
  const int arm = std::max(2, h / 30);
  level_line(picture, w / 2 - arm, w / 2 + arm + 1, h / 2);
  upright_line(picture, w / 2, h / 2 - arm, h / 2 + arm + 1);
  draw_inner(picture, 90);
  draw_inner(picture, 80);
}

void darken(ImageView<Rgbx8> picture, int x, int y, Size size) {
  const int right = std::min(x + size.width, picture.size.width);
  const int bottom = std::min(y + size.height, picture.size.height);
  for (int v = std::max(y, 0); v < bottom; ++v)
    for (int u = std::max(x, 0); u < right; ++u) {
      Rgbx8& p = picture.row(v)[u];
      p = {half(p.r), half(p.g), half(p.b), half(p.x + 255)};
    }
}

void draw_border(ImageView<Rgbx8> picture, int width_px, Rgb8 ink) {
  const int w = picture.size.width, h = picture.size.height;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (std::min({x, y, w - 1 - x, h - 1 - y}) < width_px)
        picture.row(y)[x] = {ink.r, ink.g, ink.b, 255};
}

void draw_placeholder(ImageView<Rgbx8> picture) {
  const int w = picture.size.width, h = picture.size.height;
  for (int y = 0; y < h; ++y) std::fill_n(picture.row(y), w, kEmpty);
  for (int y = 0; y < h; ++y) {
    const int x = static_cast<int>(static_cast<long>(y) * (w - 1) / std::max(h - 1, 1));
    picture.row(y)[x] = picture.row(y)[w - 1 - x] = kEmptyLine;
  }
}

}  // namespace mixrig::viewfinder
