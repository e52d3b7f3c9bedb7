// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/scraps.h"

#include <algorithm>
#include <utility>

namespace mixrig::measure {
namespace {

constexpr int kBackground = 0, kPerson = kLayerPerson, kObject = kLayerVirtual;

/// Whether truth has a layer in the 3x3 pixels around one.
bool is_near(ImageView<const std::uint8_t> labels, int x, int y, int layer) {
  const Size size = labels.size;
  for (int v = std::max(0, y - 1); v <= std::min(size.height - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(size.width - 1, x + 1); ++u)
      if ((labels.row(v)[u] & kLayerMask) == layer) return true;
  return false;
}

Scrap kind_of(int shown, int is) {
  if (shown == kPerson && is == kObject) return Scrap::kPersonThroughObject;
  if (shown == kObject && is == kPerson) return Scrap::kObjectThroughPerson;
  return shown == kBackground ? Scrap::kRoomThrough : Scrap::kOverRoom;
}

int least_scrap_px(Size size) {
  const double share = static_cast<double>(size.area()) / (1280.0 * 1024.0);
  return std::max(2, static_cast<int>(kLeastScrap_px * share + 0.5));
}

Image<std::uint8_t> wrong_pixels(ImageView<const std::uint8_t> layer,
                                 ImageView<const std::uint8_t> labels) {
  Image<std::uint8_t> out(labels.size);
  for (int y = 0; y < labels.size.height; ++y)
    for (int x = 0; x < labels.size.width; ++x) {
      const int shown = layer.row(y)[x], label = labels.row(y)[x];
      if (shown != kObject && (label & kInSilhouette) == 0) continue;
      if (shown == (label & kLayerMask) || is_near(labels, x, y, shown)) continue;
      out.row(y)[x] =
          static_cast<std::uint8_t>(1 + static_cast<int>(kind_of(shown, label & kLayerMask)));
    }
  return out;
}

}  // namespace

/// The piece at a pixel of wrong_, which is taken out; its pixels lie in piece_.
Piece ScrapJudge::take_piece(int x, int y) {
  const int width = wrong_.width(), height = wrong_.height();
  const std::uint8_t mark = wrong_.row(y)[x];
  int x0 = x, x1 = x, y0 = y, y1 = y;
  piece_.clear();
  open_.assign(1, y * width + x);
  wrong_.row(y)[x] = 0;
  while (!open_.empty()) {
    const int at = open_.back(), u = at % width, v = at / width;
    open_.pop_back();
    piece_.push_back(at);
    x0 = std::min(x0, u), x1 = std::max(x1, u), y0 = std::min(y0, v), y1 = std::max(y1, v);
    for (int j = std::max(0, v - 1); j <= std::min(height - 1, v + 1); ++j)
      for (int i = std::max(0, u - 1); i <= std::min(width - 1, u + 1); ++i) {
        if (wrong_.row(j)[i] != mark) continue;
        wrong_.row(j)[i] = 0;
        open_.push_back(j * width + i);
      }
  }
  return {static_cast<Scrap>(mark - 1),
          static_cast<int>(piece_.size()),
          x0,
          y0,
          x1 - x0 + 1,
          y1 - y0 + 1};
}

void ScrapJudge::add_piece(const Piece& piece) {
  if (piece.pixels < least_scrap_px(wrong_.size())) {
    sums_.specks += piece.kind != Scrap::kOverRoom;
    return;
  }
  ++sums_.scraps[static_cast<std::size_t>(piece.kind)];
  sums_.scrap_pixels += static_cast<std::uint64_t>(piece.pixels);
  sums_.largest_px = std::max(sums_.largest_px, piece.pixels);
  if (piece.pixels > worst_.pixels) worst_ = piece;
  for (const int at : piece_) scraps_.row(at / scraps_.width())[at % scraps_.width()] = 1;
}

void ScrapJudge::count_ghosts(ImageView<const std::uint8_t> matte, const TruthImages& truth) {
  const Image<std::uint8_t> band = matte_band(truth.matte, kBand_px);
  for (int y = 0; y < matte.size.height; ++y)
    for (int x = 0; x < matte.size.width; ++x) {
      const int share = matte.row(y)[x];
      if (share >= kGhostLeast && share <= kGhostMost && band.row(y)[x] == 0) ++sums_.ghost_pixels;
    }
}

void ScrapJudge::add(ImageView<const std::uint8_t> layer, ImageView<const std::uint8_t> matte,
                     const TruthImages& truth) {
  const Size size = truth.labels.size;
  wrong_ = wrong_pixels(layer, truth.labels);
  std::swap(scraps_, before_);
  scraps_.reset(size);
  scraps_.fill(0);
  worst_ = {};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (wrong_.row(y)[x] != 0) add_piece(take_piece(x, y));
  if (before_.size() == size)
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        sums_.changed_pixels += scraps_.row(y)[x] != before_.row(y)[x];
  count_ghosts(matte, truth);
  ++sums_.frames;
}

Errors::Scraps scraps_of(const ScrapSums& sums) {
  Errors::Scraps out;
  if (sums.frames == 0) return out;
  const auto a_frame = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(sums.frames);
  };
  const auto of = [&](Scrap kind) { return a_frame(sums.scraps[static_cast<std::size_t>(kind)]); };
  out.person_through_object = of(Scrap::kPersonThroughObject);
  out.object_through_person = of(Scrap::kObjectThroughPerson);
  out.room_through = of(Scrap::kRoomThrough);
  out.over_room = of(Scrap::kOverRoom);
  out.pixels = a_frame(sums.scrap_pixels);
  out.largest_px = sums.largest_px;
  out.changed_pixels = a_frame(sums.changed_pixels);
  out.specks = a_frame(sums.specks);
  out.ghost_pixels = a_frame(sums.ghost_pixels);
  return out;
}

}  // namespace mixrig::measure
