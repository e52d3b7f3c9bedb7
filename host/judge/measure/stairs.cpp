// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/stairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace mixrig::measure {
namespace {

constexpr int kReach_px = 6, kEnd_px = 3;  // across, to either side; of these, where it is even
constexpr std::size_t kAcross = 2 * kReach_px;
constexpr double kLeastStep = 24;       // of 255
constexpr double kEvenPart = 0.2;       // of the step, over an end
constexpr double kStraight_px = 1;      // from the line, at most
constexpr double kSteepestSlope = 0.9;  // the other axis finds what is steeper

/// A picture by its columns, or by its rows: `along` numbers them.
struct Lines {
  ImageView<const Rgb8> color;
  ImageView<const std::uint8_t> labels;
  bool rows;

  int count() const { return rows ? color.size.height : color.size.width; }
  int length() const { return rows ? color.size.width : color.size.height; }
  double luma(int along, int across) const {
    const Rgb8 c = rows ? color.row(along)[across] : color.row(across)[along];
    return (77.0 * c.r + 150.0 * c.g + 29.0 * c.b) / 256;
  }
  int layer(int along, int across) const {
    return (rows ? labels.row(along)[across] : labels.row(across)[along]) & kLayerMask;
  }
};

struct Crossing {
  double at_px, width_px;
};

/// Finds where a step from 0 to 1 first passes a share, between its ends.
std::optional<double> passes(const std::array<double, kAcross>& step, double share) {
  for (std::size_t k = kEnd_px - 1; k + kEnd_px < kAcross; ++k)
    if (step[k] < share && step[k + 1] >= share)
      return static_cast<double>(k) + (share - step[k]) / (step[k + 1] - step[k]);
  return std::nullopt;
}

/// Measures the step of brightness where labels change after pixel `across` of a line; nullopt
/// where its sides are not even or too alike.
std::optional<Crossing> crossing(const Lines& lines, int along, int across) {
  const int before = lines.layer(along, across), after = lines.layer(along, across + 1);
  std::array<double, kAcross> step;
  for (int k = 0; k < 2 * kReach_px; ++k) {
    const int at = across + 1 - kReach_px + k;
    if (lines.layer(along, at) != (k < kReach_px ? before : after)) return std::nullopt;
    step[static_cast<std::size_t>(k)] = lines.luma(along, at);
  }
  const auto end_of = [&](std::size_t first) {
    const auto [least, most] = std::minmax({step[first], step[first + 1], step[first + 2]});
    return std::pair((step[first] + step[first + 1] + step[first + 2]) / kEnd_px, most - least);
  };
  const auto [low, low_uneven] = end_of(0);
  const auto [high, high_uneven] = end_of(kAcross - kEnd_px);
  const double height = high - low;
  if (std::abs(height) < kLeastStep ||
      std::max(low_uneven, high_uneven) > kEvenPart * std::abs(height))
    return std::nullopt;
  for (double& s : step) s = (s - low) / height;
  const auto tenth = passes(step, 0.1), half = passes(step, 0.5), rest = passes(step, 0.9);
  if (!tenth || !half || !rest || *rest < *tenth) return std::nullopt;
  return Crossing{across + 1 - kReach_px + *half, *rest - *tenth};
}

/// A border between a layer and the background on a line; `after` is the pixel before it.
struct Border {
  int after;
  double at_px, width_px;
  bool taken = false;  ///< belongs to a piece
};

/// The borders of each line, in order.
using Borders = std::vector<std::vector<Border>>;

Borders borders_of(const Lines& lines, int layer) {
  Borders borders(static_cast<std::size_t>(lines.count()));
  for (int i = 0; i < lines.count(); ++i)
    for (int j = kReach_px - 1; j + kReach_px < lines.length(); ++j) {
      const int a = lines.layer(i, j), b = lines.layer(i, j + 1);
      if (a == b || std::min(a, b) != 0 || std::max(a, b) != layer) continue;
      if (const auto found = crossing(lines, i, j))
        borders[static_cast<std::size_t>(i)].push_back({j, found->at_px, found->width_px});
    }
  return borders;
}

/// The border of a line after a pixel that no piece has; null if there is none.
Border* free_border(std::vector<Border>& line, int after) {
  for (Border& border : line)
    if (border.after == after) return border.taken ? nullptr : &border;
  return nullptr;
}

using StairPiece = std::array<Border*, kStairPiece_px>;

/// The piece that begins at a border of line `i`: the neighbour on each of the next lines. nullopt
/// where it ends too soon.
std::optional<StairPiece> piece_from(Borders& borders, std::size_t i, Border& first) {
  if (i + kStairPiece_px > borders.size()) return std::nullopt;
  StairPiece piece{&first};
  for (std::size_t k = 1; k < piece.size(); ++k) {
    Border* next = nullptr;
    for (const int step : {0, -1, 1})
      if (next == nullptr) next = free_border(borders[i + k], piece[k - 1]->after + step);
    if (next == nullptr) return std::nullopt;
    piece[k] = next;
  }
  return piece;
}

struct Line {
  double first_px, slope;
  double at(std::size_t i) const { return first_px + slope * static_cast<double>(i); }
};
Line line_through(std::span<const double> places_px) {
  const auto count = static_cast<double>(places_px.size());
  double mean = 0, products = 0, squares = 0;
  for (const double p : places_px) mean += p / count;
  for (std::size_t i = 0; i < places_px.size(); ++i) {
    const double from_middle = static_cast<double>(i) - 0.5 * (count - 1);
    products += from_middle * (places_px[i] - mean), squares += from_middle * from_middle;
  }
  const double slope = products / squares;
  return {mean - 0.5 * slope * (count - 1), slope};
}

/// Adds a piece where it is straight, and takes its borders.
void add_piece(const StairPiece& piece, Stairs& sums) {
  std::array<double, kStairPiece_px> places;
  double width_px = 0;
  for (std::size_t k = 0; k < piece.size(); ++k) {
    places[k] = piece[k]->at_px, piece[k]->taken = true;
    width_px += piece[k]->width_px / double(kStairPiece_px);
  }
  const Line line = line_through(places);
  if (std::abs(line.slope) > kSteepestSlope) return;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (std::abs(places[k] - line.at(k)) > kStraight_px) return;
  sums.off_line_px.add(mean_off_line_px(places));
  sums.width_px.add(width_px / std::sqrt(1 + line.slope * line.slope));
}

}  // namespace

double mean_off_line_px(std::span<const double> places_px) {
  const Line line = line_through(places_px);
  double sum = 0;
  for (std::size_t i = 0; i < places_px.size(); ++i) sum += std::abs(places_px[i] - line.at(i));
  return sum / (static_cast<double>(places_px.size()) * std::sqrt(1 + line.slope * line.slope));
}

void add_stairs(ImageView<const Rgb8> color, ImageView<const std::uint8_t> labels,
                std::uint8_t layer, Stairs& sums) {
  for (const bool rows : {false, true}) {
    const Lines lines{color, labels, rows};
    Borders borders = borders_of(lines, layer);
    for (std::size_t i = 0; i < borders.size(); ++i)
      for (Border& first : borders[i])
        if (!first.taken)
          if (const auto piece = piece_from(borders, i, first)) add_piece(*piece, sums);
  }
}

}  // namespace mixrig::measure
