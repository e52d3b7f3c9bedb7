// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/room_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/render/cpu/key/key.h"
#include "host/render/frame/room_light.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kOfRoom = static_cast<std::uint8_t>(PixelState::kBackground);

/// Sums over the compared pixels of a block: their number, squared noise of plate and learned
/// colour, and of each channel plate, learned colour and their products.
enum Sum : std::size_t {
  kCount,
  kNoise2,
  kPlate,
  kLearned = kPlate + 3,
  kPP = kLearned + 3,
  kPB = kPP + 3,
  kBB = kPB + 3,
  kSums = kBB + 3
};

/// Light, and the squared change within the block; 0 if too few pixels were compared or they differ
/// from the room in more than light.
glm::vec4 found_light(const std::array<float, kSums>& sums) {
  const auto channels = [&](std::size_t at) {
    return glm::vec3(sums[at], sums[at + 1], sums[at + 2]);
  };
  const float n = sums[kCount];
  if (n < kRoomLightLeast) return glm::vec4(0);
  const glm::vec3 pb = channels(kPB), learned = channels(kLearned), floor(n * kColorNoise);
  const glm::vec3 rest = channels(kPP) - pb * pb / glm::max(channels(kBB), glm::vec3(1e-8F));
  const float noise2 = sums[kNoise2], mean = luminance(learned) / n;
  const float change2 = ((rest.r + rest.g + rest.b) / 3 - noise2) / (n * mean * mean + 1e-8F);
  if (change2 > kRoomLightRest * kRoomLightRest) return glm::vec4(0);
  const glm::vec3 light = (channels(kPlate) + floor) / (learned + floor);
  const float least = std::min({light.r, light.g, light.b});
  if (least < kRoomLightHue * std::max({light.r, light.g, light.b})) return glm::vec4(0);
  return {light, std::max(0.0F, change2)};
}

/// Sums of the pixels in the columns x .. x + kLanes - 1 of row `by` of blocks, before column
/// `end`.
std::array<FloatLanes, kSums> compared(const KeyInput& input, const Image<std::uint8_t>& state,
                                       int x, int end, int by) {
  const Size size = input.tables.view_size;
  std::array<FloatLanes, kSums> sums{};
  for (int y = block_begin(by) + kRoomLightRow; y < block_end(by, size.height);
       y += kRoomLightRows) {
    const ColorLanes p = color_lanes(input.plate.row(y), x, size.width);
    const ColorLanes learned = color_lanes(input.background.color.row(y), x, size.width);
    const ColorLanes b = shown_now(input.tone, learned);
    const FloatLanes light = luminance(b), now = luminance(p);
    const FloatLanes sigma = input.learned_sigma(x, y);
    const FloatLanes last = FloatLanes{} + static_cast<float>(end - x);
    const IntLanes room = (byte_lanes(state.row(y), x, state.width()) == kOfRoom) &
                          (lane_numbers() < last) & (learned.r >= 0) &
                          (now > kDeepestShadow * light) & (now < kRoomLightMost * light);
    const FloatLanes one = room ? FloatLanes{} + 1 : FloatLanes{};
    sums[kCount] += one;
    sums[kNoise2] += one * (sigma * sigma + kColorNoise * kColorNoise);
    const std::array<std::pair<FloatLanes, FloatLanes>, 3> channels{
        {{p.r, b.r}, {p.g, b.g}, {p.b, b.b}}};
    for (std::size_t c = 0; c < 3; ++c) {
      const FloatLanes plate = one * channels[c].first, room_c = one * channels[c].second;
      sums[kPlate + c] += plate, sums[kLearned + c] += room_c, sums[kPP + c] += plate * plate;
      sums[kPB + c] += plate * room_c, sums[kBB + c] += room_c * room_c;
    }
  }
  return sums;
}

}  // namespace

RoomLight::RoomLight(Size blocks)
    : found_(blocks),
      columns_({blocks.width * kBlockPx + 2 * kMargin, kPlanes * blocks.height}, 1) {}

void RoomLight::compare(const KeyInput& input, const BlockPlanes& planes,
                        const Image<std::uint8_t>& state, int by) {
  const int width = input.tables.view_size.width;
  std::fill_n(found_.row(by), found_.width(), glm::vec4(0));
  constexpr int kMost = 2;
  static_assert(kMost * kBlockPx % kLanes == 0);
  block_runs(planes.decided2.row(by), found_.width(), kMost, [&](int b0, int b1) {
    std::array<std::array<float, kSums>, kMost> blocks{};
    const int x0 = block_begin(b0), end = std::min(width, block_begin(b1));
    for (int x = x0; x < x0 + kMost * kBlockPx; x += kLanes) {
      const std::array<FloatLanes, kSums> sums = compared(input, state, x, end, by);
      for (int i = 0; i < kLanes; ++i) {
        auto& block = blocks[static_cast<std::size_t>((x - x0 + i) / kBlockPx)];
        for (std::size_t k = 0; k < kSums; ++k) block[k] += sums[k][i];
      }
    }
    for (int bx = b0; bx < b1; ++bx)
      if (planes.foreground.row(by)[bx] == 0)
        found_.row(by)[bx] = found_light(blocks[static_cast<std::size_t>(bx - b0)]);
  });
}

glm::vec4 RoomLight::around(int bx, int by) const {
  glm::vec3 sum(0), squares(0);
  float n = 0, within2 = 0;
  const int x0 = std::max(0, bx - kRoomLightBlocks);
  const int x1 = std::min(found_.width() - 1, bx + kRoomLightBlocks);
  for (int y = std::max(0, by - kRoomLightBlocks);
       y <= std::min(found_.height() - 1, by + kRoomLightBlocks); ++y)
    for (int x = x0; x <= x1; ++x) {
      const glm::vec4& found = found_.row(y)[x];
      if (found.x == 0) continue;
      const glm::vec3 light(found);
      n += 1, sum += light, squares += light * light, within2 += found.w;
    }
  if (n == 0) return {1, 1, 1, kColorFlicker};
  const glm::vec3 light = sum / n, between2 = squares - light * sum;
  const float change2 = within2 + std::max(0.0F, (between2.r + between2.g + between2.b) / 3);
  constexpr float kPrior2 = kRoomLightPrior * kColorFlicker * kColorFlicker;
  return {light, std::min(std::sqrt((change2 + kPrior2) / (n + kRoomLightPrior)), kRoomLightVary)};
}

void RoomLight::average(const BlockPlanes& planes, int by) {
  const int last = found_.width() - 1;
  for (int bx = 0; bx <= last; ++bx) {
    if (!planes.decided1.row(by)[bx]) continue;
    const glm::vec4 light = around(bx, by);
    const int before = bx == 0 ? 1 : 0, after = bx == last ? kMargin : 0;
    for (int c = 0; c < kPlanes; ++c)
      std::fill_n(columns_.row(kPlanes * by + c) + kMargin + block_begin(bx) - before,
                  kBlockPx + before + after, light[c]);
  }
}

}  // namespace mixrig::render::cpu
