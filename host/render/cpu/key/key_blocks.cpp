// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/key_blocks.h"

#include "host/render/contract/compositor.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kHidden = static_cast<std::uint8_t>(PixelState::kUnknown);
constexpr auto kSpeckleFrom = static_cast<std::uint8_t>(PixelState::kForeground);
constexpr auto kSpeckleTo = static_cast<std::uint8_t>(PixelState::kBackground);

/// Joins values within `radius` of each place into `to`, first along rows, then along columns.
template <typename From, typename T, typename Join>
void join_around(const Image<From>& from, int radius, Image<T>& rows, Image<T>& to, Join&& join) {
  const int width = from.width(), height = from.height();
  for (int y = 0; y < height; ++y) {
    const From* in = from.row(y);
    T* out = rows.row(y);
    std::copy_n(in, width, out);
    for (int d = 1; d <= std::min(radius, width - 1); ++d) {
      for (int x = 0; x < width - d; ++x) out[x] = join(out[x], in[x + d]);
      for (int x = d; x < width; ++x) out[x] = join(out[x], in[x - d]);
    }
  }
  for (int y = 0; y < height; ++y) {
    const int first = std::max(0, y - radius), last = std::min(height - 1, y + radius);
    T* out = to.row(y);
    std::copy_n(rows.row(first), width, out);
    for (int j = first + 1; j <= last; ++j) {
      const T* in = rows.row(j);
      for (int x = 0; x < width; ++x) out[x] = join(out[x], in[x]);
    }
  }
}

constexpr auto kAdd = [](std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>(a + b);
};

/// Counts eight states at once; in binary foreground is 10, doubt 11, unknown 00.
struct RowCount {
  std::uint64_t foreground = 0;  ///< a byte a column
  std::uint64_t doubt = 0, unknown = 0;
  void add(const std::uint8_t* states) {
    constexpr std::uint64_t kOnes = 0x0101010101010101U;
    const auto eight = load<std::uint64_t>(states);
    const std::uint64_t high = (eight >> 1) & kOnes, low = eight & kOnes;
    foreground += high & ~low;
    doubt |= high & low;
    unknown |= (high | low) ^ kOnes;
  }
};

}  // namespace

BlockPlanes::BlockPlanes(Size blocks) {
  for (Plane* plane : {&foreground, &others, &mirrored, &unknown, &doubt, &band, &near, &decided,
                       &decided1, &decided2, &sampled, &any_, &rows_})
    plane->reset(blocks);
  sum_.reset(blocks), mirrored_sum_.reset(blocks), row_sum_.reset(blocks);
}

void BlockPlanes::count(const Image<std::uint8_t>& state, int bx, int by, int pixels) {
  RowCount c;
  for (int y = block_begin(by); y < block_begin(by + 1); ++y) c.add(state.row(y) + block_begin(bx));
  static_assert(kBlockPx == 8);
  const auto sum = static_cast<std::uint8_t>((c.foreground * 0x0101010101010101U) >> 56U);
  foreground.row(by)[bx] = sum;
  others.row(by)[bx] = sum < pixels;
  doubt.row(by)[bx] = c.doubt != 0;
  unknown.row(by)[bx] = c.unknown != 0;
}

/// Replaces one state of a block by background.
void BlockPlanes::replace(int bx, int by, std::uint8_t from, Image<std::uint8_t>& state) const {
  for (int y = block_begin(by); y < block_begin(by + 1); ++y)
    std::replace(state.row(y) + block_begin(bx), state.row(y) + block_begin(bx + 1), from,
                 kSpeckleTo);
}

/// Turns unknown pixels beside a mirror's depth into background.
void BlockPlanes::end_mirrors(Image<std::uint8_t>& state) {
  join_around(foreground, kBandBlocks, row_sum_, sum_, kAdd);
  join_around(mirrored, kBandBlocks, row_sum_, mirrored_sum_, kAdd);
  for (int by = 0; by < foreground.height(); ++by)
    for (int bx = 0; bx < foreground.width(); ++bx) {
      const float least = kMirrorPart * static_cast<float>(sum_.row(by)[bx]);
      if (static_cast<float>(mirrored_sum_.row(by)[bx]) <= least) continue;
      replace(bx, by, kHidden, state);
      unknown.row(by)[bx] = 0;
    }
}

void BlockPlanes::drop_speckles(float tof_px, Image<std::uint8_t>& state) {
  end_mirrors(state);
  join_around(foreground, kSpeckleBlocks, row_sum_, sum_, kAdd);
  join_around(mirrored, kSpeckleBlocks, row_sum_, mirrored_sum_, kAdd);
  for (int by = 0; by < foreground.height(); ++by)
    for (int bx = 0; bx < foreground.width(); ++bx) {
      const int sum = sum_.row(by)[bx];
      const float least = sum < mirrored_sum_.row(by)[bx] ? kMirrorSpeckleTofPx : kSpeckleTofPx;
      if (foreground.row(by)[bx] == 0 || static_cast<float>(sum) >= least * tof_px) continue;
      replace(bx, by, kSpeckleFrom, state);
      foreground.row(by)[bx] = 0;
      others.row(by)[bx] = 1;
    }
}

void BlockPlanes::find_band(bool room) {
  const auto either = [](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(a | b);
  };
  const auto widen = [&](const Plane& from, int radius, Plane& to) {
    join_around(from, radius, rows_, to, either);
  };
  const int width = foreground.width(), height = foreground.height();
  const auto each = [&](auto&& set) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) set(y, x);
  };
  each([&](int y, int x) { any_.row(y)[x] = foreground.row(y)[x] > 0; });
  widen(any_, kNearBlocks, near);
  // A border lies inside a block or between two blocks: either way some block sees both sides.
  widen(any_, kBandBlocks, band);
  widen(others, kBandBlocks, decided);
  each([&](int y, int x) {
    band.row(y)[x] &= decided.row(y)[x];
    decided.row(y)[x] = band.row(y)[x] | doubt.row(y)[x] | (near.row(y)[x] & unknown.row(y)[x]);
  });
  widen(decided, 1, decided1);
  widen(decided, 2, decided2);
  widen(decided, kNearBlocks, sampled);
  each([&](int y, int x) {
    const bool needed = any_.row(y)[x] || (room && others.row(y)[x]);
    sampled.row(y)[x] = sampled.row(y)[x] && needed;
  });
}

}  // namespace mixrig::render::cpu
