// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/key_votes.h"

#include <algorithm>
#include <cmath>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/key/key_colors.h"
#include "host/render/frame/room_light.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kVotedUnknown = static_cast<std::uint8_t>(PixelState::kUnknown);
constexpr auto kVotedBackground = static_cast<std::uint8_t>(PixelState::kBackground);
constexpr auto kVotedForeground = static_cast<std::uint8_t>(PixelState::kForeground);
constexpr auto kVotedDoubt = static_cast<std::uint8_t>(PixelState::kEdge);

/// Values of depth taps are stored in fifths, so that bytes hold their sums.
constexpr int kFifths = 5, kDepthTaps = (2 * kDepthTapRadius + 1) * (2 * kDepthTapRadius + 1);
static_assert(kUnknownShare * kFifths == 2 && kDepthTaps * kFifths < 256);

FloatLanes clamp(FloatLanes v, FloatLanes least, FloatLanes most) {
  return min(max(v, least), most);
}

/// Squared distance to the room over its variance, that variance, and the largest vote.
struct RoomDistance {
  FloatLanes square, variance, most;
};

/// The learned colours of the room: `sigma`, their standard deviation; `light`, the room's light
/// around over theirs, and `flicker`, its standard deviation.
struct LearnedRoom {
  ColorLanes color, light;
  FloatLanes sigma, flicker;
};

/// `b`: the room's light now. `darkest`: what is darker than this factor of b is no shadow.
RoomDistance to_room(const KeyInput& input, const ColorLanes& p, const ColorLanes& b,
                     const LearnedRoom& room, FloatLanes darkest) {
  constexpr FloatLanes kOne = FloatLanes{} + 1;
  const FloatLanes floor = kColorNoise + room.flicker * luminance(b);
  const FloatLanes variance = room.sigma * room.sigma + floor * floor;
  const FloatLanes shade = dot(p, b) / max(dot(b, b), FloatLanes{} + 1e-8F);
  const FloatLanes k = clamp(shade, FloatLanes{} + kDarkestShadow, kOne);
  const ColorLanes d{p.r - k * b.r, p.g - k * b.g, p.b - k * b.b};
  const FloatLanes deep = clamp(shade, darkest, kOne);
  const ColorLanes off{p.r - deep * b.r, p.g - deep * b.g, p.b - deep * b.b};
  const FloatLanes cap = FloatLanes{} + kColorVoteCap;
  const IntLanes no_shadow = dot(off, off) > kOtherColor * variance;
  return {dot(d, d) / variance, variance,
          input.moving ? cap : (no_shadow ? FloatLanes{} + kOtherVoteCap : cap)};
}

/// By the learned light or, where that is nearer to the plate, by the light found around.
RoomDistance to_learned(const KeyInput& input, const ColorLanes& p, const LearnedRoom& room) {
  ColorLanes b = shown_now(input.tone, room.color);
  FloatLanes darkest = FloatLanes{} + kDeepestShadow;
  if (input.finds_light()) {
    // The darkest shadow is relative to the learned light.
    const FloatLanes least = kDeepestShadow * luminance(b);
    b = nearer_to(p, b, {room.light.r * b.r, room.light.g * b.g, room.light.b * b.b});
    darkest = min(least / max(luminance(b), FloatLanes{} + 1e-4F), FloatLanes{} + 1);
  }
  RoomDistance distance = to_room(input, p, b, room, darkest);
  // An unknown colour does not vote.
  distance.most = room.color.r < 0 ? FloatLanes{} : distance.most;
  return distance;
}

/// Squared distance to a colour over its variance.
FloatLanes square_to(const ColorLanes& p, const NearColor& c) {
  const ColorLanes d{p.r - c.mean.r, p.g - c.mean.g, p.b - c.mean.b};
  return dot(d, d) / c.variance;
}

/// A colour of people, whose brightness varies: distances are those of the covariance
/// v*I + s^2*m*m^T of variance v, mean m and s = kPeopleShade, by the formula of Sherman and
/// Morrison. Its determinant is that of v*I, so that a person in the room's colour is as likely as
/// the room.
struct ShadedColor {
  explicit ShadedColor(const NearColor& c)
      : mean(c.mean),
        over(1 / c.variance),
        along(kPeopleShade * kPeopleShade /
              (c.variance + kPeopleShade * kPeopleShade * glm::dot(mean, mean))),
        log_spread(kSpreadOdds * std::log(c.variance)) {}
  glm::vec3 mean;
  float over, along, log_spread;
  /// Log odds of a plate's colour, without constants.
  FloatLanes odds(const ColorLanes& p) const {
    const ColorLanes d{p.r - mean.r, p.g - mean.g, p.b - mean.b};
    const FloatLanes by_light = d.r * mean.r + d.g * mean.g + d.b * mean.b;
    return -0.5F * over * (dot(d, d) - along * by_light * by_light) - log_spread;
  }
};

/// Light flickers on people as on the room beside them: a person in the room's colour is as likely
/// as the room.
float people_flicker(const KeyInput& input, const RoomLight& light, int bx, int by) {
  if (!input.finds_light()) return kColorFlicker;
  return std::min(kColorFlicker, light.flicker(block_begin(bx), by)[0]);
}

/// Magnitude of log odds that no colour reaches.
constexpr float kNoPerson = 1e9F;

/// Log odds of people by the sum of the depth taps around a pixel.
float depth_odds(std::uint8_t sum) {
  constexpr float kScale = 2.0F / (kDepthTaps * kFifths);
  const float balance = kScale * static_cast<float>(sum) - 1;
  return (balance > 0 ? kForegroundWeight : kBackgroundWeight) * balance;
}

}  // namespace

void KeyVotes::set_footprint(float tof_footprint_px) {
  for (int i = 0; i < static_cast<int>(taps_.size()); ++i)
    taps_[static_cast<std::size_t>(i)] = static_cast<int>(
        std::lround(0.5F * tof_footprint_px * static_cast<float>(i - kDepthTapRadius)));
  const auto columns = static_cast<std::size_t>(kRunPx + 2 * taps_.back());
  if (columns_.size() < columns) columns_.resize(columns);
}

void KeyVotes::load_row(const KeyInput& input, const RoomLight& light, int x0, int width, int by,
                        int j) {
  const int last = input.tables.view_size.height - 1;
  const int y = std::clamp(block_begin(by) - 1 + j, 0, last);
  const auto at = static_cast<std::size_t>(j);
  const int view_width = input.tables.view_size.width;
  for (int i = 0; i < width; i += kLanes) {
    const int x = x0 + i;
    const ColorLanes p = color_lanes(input.plate.row(y), x, view_width);
    store(r_[at].data() + i, p.r), store(g_[at].data() + i, p.g), store(b_[at].data() + i, p.b);
    if (!input.learned()) continue;
    const FloatLanes flicker =
        input.finds_light() ? light.flicker(x, by) : FloatLanes{} + kColorFlicker;
    const RoomDistance room = to_learned(input, p,
                                         {color_lanes(input.background.color.row(y), x, view_width),
                                          light.at(x, by), input.learned_sigma(x, y), flicker});
    store(distance_[at].data() + i, room.square);
    store(log_spread_[at].data() + i, log(room.variance));
    store(most_[at].data() + i, room.most);
  }
}

void KeyVotes::load_colors(const KeyInput& input, const RoomLight& light, int bx0, int bx1,
                           int by) {
  for (int j = 0; j < kRows; ++j)
    load_row(input, light, block_begin(bx0) - 1, (bx1 - bx0) * kBlockPx + 2, by, j);
}

/// Averages votes over 3x3 pixels (kVoteSide) in the block whose first pixel is i0.
void KeyVotes::mean_of_colors(const KeyInput& input, const NearColors& near, int i0,
                              Mean& mean) const {
  const NearColor &people = near.people, &room = near.room, &deep = near.deep;
  const bool by_room = !input.learned(), known = people.known || deep.known;
  const bool by_light = input.finds_light();
  Votes votes;
  const ShadedColor person_color(people), deep_color(deep);
  const float room_spread = kSpreadOdds * std::log(room.variance);
  for (std::size_t j = 0; j < kRows; ++j)
    for (int i = 0; i < kRows; i += kLanes) {
      const auto at = [&](const Rows& rows) { return load<FloatLanes>(rows[j].data() + i0 + i); };
      const ColorLanes p{at(r_), at(g_), at(b_)};
      FloatLanes vote{};
      if (by_room) {
        if (people.known && room.known)
          vote = clamp(0.5F * square_to(p, room) + room_spread + person_color.odds(p),
                       FloatLanes{} - kRoomVoteCap, FloatLanes{} + kRoomVoteCap);
      } else {
        const FloatLanes most = at(most_);
        const FloatLanes least = most > 0 ? FloatLanes{} - kColorVoteCap : FloatLanes{};
        FloatLanes person = FloatLanes{} - kNoPerson;
        if (people.known) person = person_color.odds(p);
        if (deep.known) {
          // Foreground around a pixel that shows the room may lie over the room itself.
          const IntLanes by_deep = at(distance_) < (by_light ? kSurelyRoom : 0.0F);
          const FloatLanes inner = deep_color.odds(p);
          person = by_deep ? inner : max(person, inner);
        }
        vote = known ? clamp(0.5F * at(distance_) + (kSpreadOdds * at(log_spread_) + person), least,
                             most)
                     : clamp(0.5F * at(distance_) - kColorVoteCap, least,
                             min(most, FloatLanes{} + kColorVoteCap));
      }
      store(votes[j].data() + i, vote);
    }
  const float side = by_light ? kVoteSide : 1, all = 1 / ((1 + 2 * side) * (1 + 2 * side));
  const std::array<float, 3> weights{side, 1, side};
  for (std::size_t j = 0; j < kBlockPx; ++j)
    for (std::size_t i = 0; i < kBlockPx; ++i) {
      float sum = 0;
      for (std::size_t dj = 0; dj < 3; ++dj)
        for (std::size_t di = 0; di < 3; ++di)
          sum += weights[dj] * weights[di] * votes[j + dj][i + di];
      mean[j][i] = all * sum;
    }
}

/// Sums the depth taps, in fifths, around the pixels x0 .. x1 - 1 of row y. The taps form a grid of
/// columns and rows; beyond the picture its border repeats.
void KeyVotes::sum_depths(const Image<std::uint8_t>& state, Size size, int x0, int x1, int y,
                          std::uint8_t* sums) {
  const int reach = taps_.back(), left = x0 - reach, right = x1 + reach;
  const int first = std::max(0, left), count = std::min(size.width, right) - first;
  std::uint8_t* columns = columns_.data() + (first - left);
  std::fill_n(columns, count, std::uint8_t{0});
  for (const int tap : taps_) {
    const std::uint8_t* s = state.row(std::clamp(y + tap, 0, size.height - 1)) + first;
    for (int i = 0; i < count; ++i) {
      const std::uint8_t measured = s[i] == kVotedForeground ? kFifths : 2;
      columns[i] =
          static_cast<std::uint8_t>(columns[i] + (s[i] == kVotedBackground ? 0 : measured));
    }
  }
  std::fill(columns_.data(), columns, columns[0]);
  std::fill(columns + count, columns_.data() + (right - left), columns[count - 1]);
  std::fill_n(sums, x1 - x0, std::uint8_t{0});
  for (const int tap : taps_) {
    const std::uint8_t* from = columns_.data() + reach + tap;
    for (int i = 0; i < x1 - x0; ++i) sums[i] = static_cast<std::uint8_t>(sums[i] + from[i]);
  }
}

void KeyVotes::decide(const KeyInput& input, int bx0, int bx1, int by, KeyScratch& scratch,
                      Image<std::uint8_t>& matte) {
  const Size size = input.tables.view_size;
  const int x0 = block_begin(bx0), x1 = block_end(bx1 - 1, size.width), y0 = block_begin(by);
  const int rows = block_end(by, size.height) - y0;
  if (input.params.color) load_colors(input, scratch.room_light, bx0, bx1, by);
  for (int j = 0; j < rows; ++j)
    sum_depths(scratch.state, size, x0, x1, y0 + j, depths_[static_cast<std::size_t>(j)].data());
  for (int bx = bx0; bx < bx1; ++bx) {
    const bool band = scratch.planes.band.row(by)[bx], near = scratch.planes.near.row(by)[bx];
    const NearColors colors = colors_around(scratch, bx, by, band ? kBandBlocks : kNearBlocks,
                                            people_flicker(input, scratch.room_light, bx, by));
    Block& block = scratch.at(bx, by);
    block.near_w = colors.w;
    block.room_color = colors.room.known ? colors.room.mean : glm::vec3(-1);
    Mean color_odds{};
    if (input.params.color) mean_of_colors(input, colors, block_begin(bx) - x0, color_odds);
    for (int j = 0; j < rows; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const std::uint8_t* state = scratch.state.row(y0 + j) + block_begin(bx);
      const std::uint8_t* depths = depths_[at].data() + block_begin(bx) - x0;
      std::array<std::uint8_t, kBlockPx> out;
      for (std::size_t i = 0; i < kBlockPx; ++i) {
        const bool open = band | (state[i] == kVotedDoubt) | (near & (state[i] == kVotedUnknown));
        const bool foreground = state[i] == kVotedForeground;
        const float odds = color_odds[at][i] + depth_odds(depths[i]);
        const float voted = std::clamp(0.5F + 0.5F * odds, 0.0F, 1.0F);
        const float measured = foreground ? 1.0F : 0.0F;
        out[i] = static_cast<std::uint8_t>(255 * (open ? voted : measured) + 0.5F);
      }
      std::copy_n(out.data(), block_end(bx, size.width) - block_begin(bx),
                  matte.row(y0 + j) + block_begin(bx));
    }
  }
}

}  // namespace mixrig::render::cpu
