// SPDX-License-Identifier: Apache-2.0
// Finds connected wrong pieces of a composite, which averages over pixels hide.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/judge/measure/errors.h"

namespace mixrig::measure {

/// Kind of a wrong piece: what it shows instead of what is true.
enum class Scrap : std::uint8_t {
  kPersonThroughObject,  ///< a person where the object is in front
  kObjectThroughPerson,  ///< an object where the person is in front
  kRoomThrough,          ///< the room where an object or a person is in front of it
  kOverRoom,             ///< an object or a person where the room is in front
};
inline constexpr int kScrapKinds = 4;

/// A connected piece of at least this many pixels at 1280x1024 is a scrap, a smaller one a speck. A
/// smaller piece of kOverRoom is neither: truth itself is uncertain where an object stands on the
/// floor. At other sizes the limit is in proportion to the picture's area, and at least 2.
inline constexpr double kLeastScrap_px = 12;
/// A matte between these values, farther than kBand_px from the true border, is a ghost.
inline constexpr int kGhostLeast = 26, kGhostMost = 229;  ///< of 255: 0.1 and 0.9

/// A piece: kind, size and bounding box.
struct Piece {
  Scrap kind = Scrap::kPersonThroughObject;
  int pixels = 0;
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< bounding box
};

/// Sums over frames.
struct ScrapSums {
  std::uint64_t frames = 0;
  std::array<std::uint64_t, kScrapKinds> scraps{};  ///< number of each kind
  std::uint64_t scrap_pixels = 0, specks = 0, ghost_pixels = 0;
  std::uint64_t changed_pixels = 0;  ///< that are in a scrap in one of two frames in a row alone
  int largest_px = 0;
};

/// Judges frames of one size in their order. One thread.
class ScrapJudge {
 public:
  /// Judges the order of layers in pixels inside the objects' silhouette or shown as an object. A
  /// pixel is wrong where no pixel of the 3x3 around it has its layer in truth; other measures
  /// judge the exact position of borders. Pieces are connected by eight neighbours. Precondition:
  /// images of one size.
  void add(ImageView<const std::uint8_t> layer, ImageView<const std::uint8_t> matte,
           const TruthImages& truth);
  const ScrapSums& sums() const { return sums_; }
  /// Largest scrap of the last frame; 0 pixels: it has none.
  const Piece& worst() const { return worst_; }

 private:
  Piece take_piece(int x, int y);
  void add_piece(const Piece& piece);
  void count_ghosts(ImageView<const std::uint8_t> matte, const TruthImages& truth);

  ScrapSums sums_;
  Piece worst_;
  Image<std::uint8_t> wrong_;            ///< 1 + Scrap, 0 where right; pieces are taken out of it
  Image<std::uint8_t> scraps_, before_;  ///< 1 in a scrap: of this frame, and of the one before
  std::vector<std::int32_t> open_, piece_;  ///< pixels, y * width + x
};

/// Numbers per frame; nullopt without a frame.
Errors::Scraps scraps_of(const ScrapSums& sums);

}  // namespace mixrig::measure
