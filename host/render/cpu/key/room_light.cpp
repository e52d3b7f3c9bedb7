// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/room_light.h"

#include <algorithm>
#include <array>

#include "host/render/cpu/key/key.h"
#include "host/render/frame/room_light.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kOfRoom = static_cast<std::uint8_t>(PixelState::kBackground);

/// Sums over the compared pixels of a block: their number, plate and learned colour, and products
/// of both luminances.
struct Compared {
  enum Sum : std::size_t { kCount, kPlate, kLearned = kPlate + 3, kPP = kLearned + 3, kPB, kBB };
  std::array<float, kBB + 1> sums{};
  /// Light and 1; 0 if too few pixels were compared or they differ from the room in more than
  /// light.
  glm::vec4 light() const {
    const float n = sums[kCount];
    if (n < kRoomLightLeast) return glm::vec4(0);
    const float share = sums[kPB] / sums[kBB], mean = sums[kPB] / n;
    const float rest = (sums[kPP] - share * sums[kPB]) / n;
    if (rest > kRoomLightRest * kRoomLightRest * share * mean) return glm::vec4(0);
    const glm::vec3 plate(sums[kPlate], sums[kPlate + 1], sums[kPlate + 2]);
    const glm::vec3 learned(sums[kLearned], sums[kLearned + 1], sums[kLearned + 2]);
    const glm::vec3 floor(n * kColorNoise);
    const glm::vec3 light = (plate + floor) / (learned + floor);
    const float least = std::min({light.r, light.g, light.b});
    if (least < kRoomLightHue * std::max({light.r, light.g, light.b})) return glm::vec4(0);
    return {light, 1};
  }
};

}  // namespace

RoomLight::RoomLight(Size blocks)
    : found_(blocks),
      columns_({blocks.width * kBlockPx + 2 * kMargin, kChannels * blocks.height}, 1) {}

void RoomLight::compare(const KeyInput& input, const BlockPlanes& planes,
                        const Image<std::uint8_t>& state, int by) {
  const int width = input.tables.view_size.width;
  std::fill_n(found_.row(by), found_.width(), glm::vec4(0));
  constexpr int kMost = 2, kRunPx = kMost * kBlockPx;
  block_runs(planes.decided2.row(by), found_.width(), kMost, [&](int b0, int b1) {
    std::array<Compared, kMost> blocks;
    const int x0 = block_begin(b0);
    for (int y = block_begin(by) + kRoomLightRow; y < block_end(by, input.tables.view_size.height);
         y += kRoomLightRows)
      for (int x = x0; x < x0 + kRunPx; x += kLanes) {
        const ColorLanes p = color_lanes(input.plate.row(y), x, width);
        const ColorLanes learned = color_lanes(input.background.color.row(y), x, width);
        const ColorLanes b = shown_now(input.tone, learned);
        const FloatLanes light = luminance(b), now = luminance(p);
        const FloatLanes last =
            FloatLanes{} + static_cast<float>(std::min(width, block_begin(b1)) - x);
        const IntLanes room = (byte_lanes(state.row(y), x, state.width()) == kOfRoom) &
                              (lane_numbers() < last) & (learned.r >= 0) &
                              (now > kDeepestShadow * light) & (now < kRoomLightMost * light);
        const FloatLanes one = room ? FloatLanes{} + 1 : FloatLanes{};
        const std::array<FloatLanes, Compared::kBB + 1> values{
            one,       one * p.r, one * p.g,       one * p.b,         one * b.r,
            one * b.g, one * b.b, one * now * now, one * now * light, one * light * light};
        for (int i = 0; i < kLanes; i += std::min(kLanes, kBlockPx)) {
          Compared& block = blocks[static_cast<std::size_t>((x - x0 + i) / kBlockPx)];
          for (std::size_t k = 0; k < values.size(); ++k)
            for (int j = i; j < i + std::min(kLanes, kBlockPx); ++j) block.sums[k] += values[k][j];
        }
      }
    for (int bx = b0; bx < b1; ++bx)
      if (planes.foreground.row(by)[bx] == 0)
        found_.row(by)[bx] = blocks[static_cast<std::size_t>(bx - b0)].light();
  });
}

glm::vec3 RoomLight::around(int bx, int by) const {
  glm::vec4 sum(0);
  const int x0 = std::max(0, bx - kRoomLightBlocks);
  const int x1 = std::min(found_.width() - 1, bx + kRoomLightBlocks);
  for (int y = std::max(0, by - kRoomLightBlocks);
       y <= std::min(found_.height() - 1, by + kRoomLightBlocks); ++y)
    for (int x = x0; x <= x1; ++x) sum += found_.row(y)[x];
  return sum.w > 0 ? glm::vec3(sum) / sum.w : glm::vec3(1);
}

void RoomLight::average(const BlockPlanes& planes, int by) {
  const int last = found_.width() - 1;
  for (int bx = 0; bx <= last; ++bx) {
    if (!planes.decided1.row(by)[bx]) continue;
    const glm::vec3 light = around(bx, by);
    const int before = bx == 0 ? 1 : 0, after = bx == last ? kMargin : 0;
    for (int c = 0; c < kChannels; ++c)
      std::fill_n(columns_.row(kChannels * by + c) + kMargin + block_begin(bx) - before,
                  kBlockPx + before + after, light[c]);
  }
}

}  // namespace mixrig::render::cpu
