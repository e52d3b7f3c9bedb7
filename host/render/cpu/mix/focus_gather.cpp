// SPDX-License-Identifier: Apache-2.0
// Pass focus, pixels of a row: by taps of three layers, or by differences of running sums.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/contract/constants.h"
#include "host/render/cpu/mix/focus.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

/// Light and share of one layer, one pixel a lane.
struct FocusLayer {
  FloatLanes r{}, g{}, b{}, share{};
};

/// The planes at a tap of kLanes pixels; pointers to the first.
struct FocusTap {
  const float *r, *g, *b, *share, *w, *radius_px;
  FocusTap(const FocusScratch& s, int x, int y)
      : r(s.r.row(y) + x),
        g(s.g.row(y) + x),
        b(s.b.row(y) + x),
        share(s.share.row(y) + x),
        w(s.w.row(y) + x),
        radius_px(s.radius_px.row(y) + x) {}
};

void add(const FocusTap& tap, FloatLanes part, FocusLayer& layer) {
  layer.r += part * load<FloatLanes>(tap.r), layer.g += part * load<FloatLanes>(tap.g);
  layer.b += part * load<FloatLanes>(tap.b), layer.share += part * load<FloatLanes>(tap.share);
}

/// Coverage of a pixel at distance d from the centre of a disc of radius `reach`.
FloatLanes covered(FloatLanes reach, float d) {
  return min(max(reach + (0.5F - d), FloatLanes{}), FloatLanes{} + 1.0F);
}

void store_lanes(const FocusScratch& s, FloatLanes r, FloatLanes g, FloatLanes b, int count,
                 Rgb8* to) {
  const auto step_of = [](FloatLanes light) {
    return truncate(min(max(light, FloatLanes{}), FloatLanes{} + 1.0F) * 65535.0F + 0.5F);
  };
  const IntLanes red = step_of(r), green = step_of(g), blue = step_of(b);
  for (int i = 0; i < count; ++i)
    to[i] = {s.srgb_byte[static_cast<std::size_t>(red[i])],
             s.srgb_byte[static_cast<std::size_t>(green[i])],
             s.srgb_byte[static_cast<std::size_t>(blue[i])]};
}

/// Composites `before` over `own` over `behind`; the others make up for an empty layer.
void resolve(const FocusScratch& s, const FocusLayer& before, const FocusLayer& own,
             const FocusLayer& behind, float weight, int count, Rgb8* to) {
  const FloatLanes none{}, one = none + 1.0F, least = none + kFocusNoLight;
  const FloatLanes front = min(weight * before.share, one);
  const FloatLanes middle = min(weight * own.share, one);
  const FloatLanes any_behind = weight * behind.share > least ? one : none;
  const FloatLanes of_own = middle * (one - front);
  const FloatLanes rest = any_behind * (one - middle) * (one - front);
  const FloatLanes total = max(front + of_own + rest, least);
  const FloatLanes a = front / max(before.share * total, least * total);
  const FloatLanes o = of_own / max(own.share * total, least * total);
  const FloatLanes f = rest / max(behind.share * total, least * total);
  store_lanes(s, a * before.r + o * own.r + f * behind.r, a * before.g + o * own.g + f * behind.g,
              a * before.b + o * own.b + f * behind.b, count, to);
}

/// Gathers the taps of kLanes pixels from (x0, y) on.
struct FocusGather {
  const FocusPass& pass;
  FloatLanes w, radius_px, step_w;
  FocusLayer before, own, behind;

  FocusGather(const FocusPass& of, int x0, int y) : pass(of) {
    w = load<FloatLanes>(of.in.w.row(y) + x0);
    radius_px = load<FloatLanes>(of.in.radius_px.row(y) + x0);
    for (int i = 0; i < kLanes; ++i) step_w[i] = focus_step(w[i], of.blur_px_m);
  }
  void add_tap(int x, int y, float d) {
    const FocusTap tap(pass.in, x, y);
    const FloatLanes off_w = load<FloatLanes>(tap.w) - w, none{};
    const FloatLanes reach = load<FloatLanes>(tap.radius_px);
    const FloatLanes part = covered(reach, d);
    // Behind an edge, the room is seen through the part of the lens that the edge leaves free.
    const FloatLanes wide = covered(max(reach, radius_px), d);
    add(tap, off_w > step_w ? part : none, before);
    add(tap, off_w < -step_w ? wide : none, behind);
    add(tap, abs(off_w) > step_w ? none : part, own);
  }
};

}  // namespace

float focus_step(float w, float blur_px_m) {
  return std::max(kFocusOneSurface * w, kFocusSameBlurPx / std::max(blur_px_m, 1e-6F));
}

void gather_focus_row(const FocusPass& pass, int x0, int y, int count, float radius_px,
                      Image<Rgb8>& to) {
  const int reach = static_cast<int>(std::ceil(radius_px));
  const int step = std::max(1, reach / pass.stride_from_px);
  const float end_2 = (radius_px + 0.5F) * (radius_px + 0.5F);
  const int first = -(reach / step) * step;
  for (int x = x0; x < x0 + count; x += kLanes) {
    FocusGather sum(pass, x, y);
    for (int dy = first; dy <= reach; dy += step)
      for (int dx = first; dx <= reach; dx += step)
        if (const auto d_2 = static_cast<float>(dx * dx + dy * dy); d_2 < end_2)
          sum.add_tap(x + dx, y + dy, std::sqrt(d_2));
    resolve(pass.in, sum.before, sum.own, sum.behind, static_cast<float>(step * step),
            std::min(kLanes, x0 + count - x), to.row(y) + x);
  }
}

void blur_focus_row(const FocusPass& pass, int x0, int y, int count, Image<Rgb8>& to) {
  const FocusScratch& s = pass.in;
  for (int x = x0; x < x0 + count; x += kLanes) {
    const int lanes = std::min(kLanes, x0 + count - x);
    const float* const radii = s.radius_px.row(y) + x;
    const auto [least, most] = std::minmax_element(radii, radii + lanes);
    const FloatLanes twice = 2.0F * load<FloatLanes>(radii), none{};
    std::array<FloatLanes, 3> light{};
    // Interpolates between discs of the table, by their means.
    for (int k = static_cast<int>(2 * *least); k <= static_cast<int>(std::ceil(2 * *most)); ++k) {
      std::array<FloatLanes, 4> sum{};
      const auto at = static_cast<std::size_t>(k);
      for (std::size_t c = at == 0 ? 0 : s.chords_end[at - 1]; c < s.chords_end[at]; ++c) {
        const FocusChord& chord = s.chords[c];
        for (std::size_t i = 0; i < sum.size(); ++i) {
          const float* const row = s.before[i].row(y + chord.dy) + x;
          sum[i] += chord.weight *
                    (load<FloatLanes>(row + chord.half + 1) - load<FloatLanes>(row - chord.half));
        }
      }
      const FloatLanes near = max(1.0F - abs(twice - static_cast<float>(k)), none);
      const FloatLanes share = near / max(sum[3], none + kFocusNoLight);
      for (std::size_t i = 0; i < light.size(); ++i) light[i] += share * sum[i];
    }
    store_lanes(s, light[0], light[1], light[2], lanes, to.row(y) + x);
  }
}

}  // namespace mixrig::render::cpu
