// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/people_cells.h"

#include <algorithm>

#include "host/render/cpu/light/background_corners.h"

namespace mixrig::render::cpu {
namespace {

/// Share of all light added to what objects hide of the lamps: where they hide less, the ratio past
/// people tends to what people leave of the lamps altogether.
constexpr float kFaintShadow = 0.02F;
/// Largest change of a lamp's share over a cell that is interpolated: people's penumbrae are wide
/// and bend little within it.
constexpr float kMostPeopleChange = 0.25F;
/// Least share of all light at which people's hidden part is computed.
constexpr float kLeastLight = 1e-6F;
/// Corners whose relative depth differs from a pixel's by at most kOneSurface show its surface;
/// others count with kOtherWeight.
constexpr float kOneSurface = 0.02F, kOtherWeight = 1e-3F;

unsigned cell_bit(int column, int row) { return 1U << (row * kCellsAcross + column); }

/// Shares of all light that objects take at the corners.
struct LostCorners {
  CornerValues ambient, lamps, past_people, by_people;
};

/// LampShares at a tile's corners, stored in a row of LightLayer::corners.
class CornerLights {
 public:
  explicit CornerLights(float* kept) : kept_(kept) {}
  float* ambient(std::size_t i) const { return kept_ + i * kLanes; }
  float* light(std::size_t lamp, std::size_t i) const { return ambient(i) + of(1 + 2 * lamp); }
  float* hidden(std::size_t lamp, std::size_t i) const { return ambient(i) + of(2 + 2 * lamp); }
  static std::size_t of(std::size_t values) { return values * kCornersPadded; }

 private:
  float* kept_;
};

void find_kept(const LightInput& input, const Doubt& doubt, const BackgroundCorners& corners,
               ImageView<const float> depth_m, const Rect& tile, BackgroundTile& known,
               const CornerLights& kept) {
  const std::size_t count = input.people->lamps.size();
  LampShares shares;
  for (std::size_t i = 0; i < corners.at.size(); ++i) {
    find_lamp_shares(input.frame, input.maps, doubt.lamps, doubt.near, corners.at[i], count,
                     shares);
    store(kept.ambient(i), shares.ambient);
    for (std::size_t k = 0; k < count; ++k)
      store(kept.light(k, i), shares.light[k]), store(kept.hidden(k, i), shares.hidden[k]);
  }
  known.flat = 0, known.has_corners = true;
  each_cell([&](int column, int row) {
    const Rect rect = cell_rect(tile, column, row);
    if (is_flat(depth_m.row(rect.y0) + rect.x0, depth_m.stride, corners.depth_m, cell(column, row)))
      known.flat |= cell_bit(column, row);
  });
}

/// Sums over the lamps, weighted by what people leave of each.
struct LampSums {
  FloatLanes by_people{}, of_lamps{}, hidden{}, hidden_past{};
  void add(FloatLanes light, FloatLanes hidden_of_it, FloatLanes seen) {
    of_lamps += light, by_people += light * (1 - seen);
    hidden += hidden_of_it, hidden_past += hidden_of_it * seen;
  }
  /// What objects hide of the lamps, and what they hide past people; never 0.
  FloatLanes lamps() const { return hidden + kFaintShadow; }
  FloatLanes past_people() const {
    const FloatLanes least = FloatLanes{} + kLeastLight;
    return hidden_past + kFaintShadow * (1 - by_people / max(of_lamps, least));
  }
};

LostCorners lost_corners(const PeopleCells& people, const CornerLights& kept) {
  LostCorners out;
  std::array<FloatLanes, kMostLamps> share;
  const std::span seen = std::span(share).first(people.seen().size());
  for (std::size_t i = 0; i < kCornersPadded / kLanes; ++i) {
    people.seen_of_register(i, seen);
    LampSums sums;
    for (std::size_t k = 0; k < seen.size(); ++k)
      sums.add(load<FloatLanes>(kept.light(k, i)), load<FloatLanes>(kept.hidden(k, i)), seen[k]);
    store(&out.ambient[i * kLanes], load<FloatLanes>(kept.ambient(i)));
    store(&out.by_people[i * kLanes], sums.by_people);
    store(&out.lamps[i * kLanes], sums.lamps());
    store(&out.past_people[i * kLanes], sums.past_people());
  }
  return out;
}

/// Computes a flat cell; `background`: its light without people.
void light_flat_past_people(const LostCorners& lost, const CellOf& c, const Rect& rect,
                            const Image<std::uint16_t>& background, Image<std::uint16_t>& out) {
  const auto each = [&](const CornerValues& v, std::array<float, kCellPx * kCellPx>& to) {
    between(v, c,
            [&](int x, int y, float f) { to[static_cast<std::size_t>(y * kCellPx + x)] = f; });
  };
  std::array<float, kCellPx * kCellPx> ambient, lamps, past_people, by_people;
  each(lost.ambient, ambient), each(lost.lamps, lamps);
  each(lost.past_people, past_people), each(lost.by_people, by_people);
  for (std::size_t i = 0; i < ambient.size(); ++i) {
    const int x = rect.x0 + static_cast<int>(i) % kCellPx,
              y = rect.y0 + static_cast<int>(i) / kCellPx;
    const float without = static_cast<float>(background.row(y)[x]) * (1 / kLinearOne);
    const float of_lamps = (1 - without - ambient[i]) * past_people[i] / lamps[i];
    const float left = 1 - by_people[i];
    out.row(y)[x] = light_to_fixed((left - ambient[i] - of_lamps) / std::max(left, kFaintShadow));
  }
}

/// Light of a cell's corners, for its pixels.
struct CellCorners {
  CornerLights light;
  const CornerValues& depth_m;
  CellOf cell;
};

/// Weights of the corners for pixels: bilinear, but small for corners of another surface.
std::array<FloatLanes, 4> corner_weights(const CellCorners& corners, FloatLanes across,
                                         FloatLanes down, FloatLanes depth) {
  const auto [a, b, c, d] = corners.cell;
  const auto weight = [&](std::size_t i, FloatLanes share) {
    const float corner_m = corners.depth_m[i];
    const FloatLanes other = (share + kOtherWeight) * kOtherWeight;
    return abs(depth - corner_m) <= kOneSurface * depth ? share + kOtherWeight : other;
  };
  std::array<FloatLanes, 4> weights = {weight(a, (1 - across) * (1 - down)),
                                       weight(b, across * (1 - down)),
                                       weight(c, (1 - across) * down), weight(d, across * down)};
  const FloatLanes over = 1 / (weights[0] + weights[1] + weights[2] + weights[3]);
  for (FloatLanes& w : weights) w *= over;
  return weights;
}

/// Computes a cell that is not flat, or over which people's shadow changes much: each pixel
/// evaluates the lamps past people, and interpolates the lamps' light from corners at its depth.
void light_pixels_past_people(const LightInput& input, const PeopleMaps& people,
                              const CellCorners& corners, ImageView<const float> depth_m,
                              const Rect& rect, LightLayer& light) {
  const auto [a, b, c, d] = corners.cell;
  std::array<FloatLanes, kMostLamps> seen;
  for (int first = 0; first < kCellPx * kCellPx; first += kLanes) {
    const CellPixels pixels(depth_m, rect.x0, rect.y0, first);
    const VectorLanes ray = pixels.ray(input.tables.warp.view);
    const FloatLanes depth = pixels.depth();
    const SurfaceLanes at{{ray.x * depth, ray.y * depth, ray.z * depth}, {}};
    if (!seen_past_people(people, at, seen)) continue;
    const std::array<FloatLanes, 4> weights =
        corner_weights(corners, pixels.across(rect), pixels.down(rect), depth);
    const auto at_pixels = [&](const float* values) {
      return weights[0] * values[a] + weights[1] * values[b] + weights[2] * values[c] +
             weights[3] * values[d];
    };
    const FloatLanes ambient = at_pixels(corners.light.ambient(0));
    LampSums sums;
    for (std::size_t k = 0; k < people.lamps.size(); ++k)
      sums.add(at_pixels(corners.light.light(k, 0)), at_pixels(corners.light.hidden(k, 0)),
               seen[k]);
    const FloatLanes without = pixels.values(light.background) * (1 / kLinearOne);
    const FloatLanes of_lamps = (1 - without - ambient) * sums.past_people() / sums.lamps();
    const FloatLanes left = max(1 - sums.by_people, FloatLanes{} + kFaintShadow);
    pixels.store_light((1 - sums.by_people - ambient - of_lamps) / left, light.visible);
  }
}

}  // namespace

PeopleCells::PeopleCells(const PeopleMaps& people, std::span<const SurfaceLanes> at)
    : count_(std::min(people.maps.size(), seen_.size())), maybe_(people.maybe) {
  std::array<FloatLanes, kMostLamps> share;
  for (std::size_t i = 0; i < at.size(); ++i) {
    hide_any_ |= seen_past_people(people, at[i], std::span(share).first(count_));
    for (std::size_t k = 0; k < count_; ++k) store(&seen_[k][i * kLanes], share[k]);
  }
}

bool PeopleCells::hide(const CellOf& c) const {
  for (std::size_t k = 0; k < count_; ++k)
    if (holds(maybe_, k) &&
        std::min({seen_[k][c.a], seen_[k][c.b], seen_[k][c.c], seen_[k][c.d]}) < 1)
      return true;
  return false;
}

bool PeopleCells::change(const CellOf& c) const {
  for (std::size_t k = 0; k < count_; ++k)
    if (holds(maybe_, k) && change_over(seen_[k], c) > kMostPeopleChange) return true;
  return false;
}

void PeopleCells::seen_of_register(std::size_t i, std::span<FloatLanes> out) const {
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = load<FloatLanes>(&seen_[k][i * kLanes]);
}

std::size_t corner_floats(std::size_t lamps) { return CornerLights::of(1 + 2 * lamps); }

bool people_allow_cells(const PinholeParams& view, const PeopleMaps& people, const Rect& tile,
                        float near_m, float far_m) {
  const float cell_m = kCellPx * far_m / std::min(view.focal_px.x, view.focal_px.y);
  LampSet narrow = people.maybe;
  for (std::size_t k = 0; k < people.lamps.size(); ++k)
    if (people.lamps[k].radius_m >= kWideInCells * cell_m) narrow &= ~(LampSet{1} << k);
  return blur_allows_cells(view, people.lamps, people.maps, narrow, tile, near_m, far_m);
}

void light_cells_past_people(const LightInput& input, const Doubt& doubt, const PeopleMaps& people,
                             ImageView<const float> depth_m, const Rect& tile,
                             BackgroundTile& known, float* kept, LightLayer& light) {
  const BackgroundCorners corners = background_corners(input, depth_m, tile);
  const PeopleCells cells(people, corners.at);
  const CornerLights of_corners(kept);
  if (!known.has_corners) find_kept(input, doubt, corners, depth_m, tile, known, of_corners);
  const LostCorners lost = lost_corners(cells, of_corners);
  each_cell([&](int column, int row) {
    const CellOf c = cell(column, row);
    const Rect rect = cell_rect(tile, column, row);
    if ((known.flat & cell_bit(column, row)) == 0 || cells.change(c))
      light_pixels_past_people(input, people, {of_corners, corners.depth_m, c}, depth_m, rect,
                               light);
    else if (cells.hide(c))
      light_flat_past_people(lost, c, rect, light.background, light.visible);
  });
}

}  // namespace mixrig::render::cpu
