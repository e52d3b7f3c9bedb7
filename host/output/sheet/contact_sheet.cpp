// SPDX-License-Identifier: Apache-2.0
#include "host/output/sheet/contact_sheet.h"

#include <algorithm>

#include "host/output/report/canvas.h"
#include "host/output/report/picture.h"

namespace mixrig::output {
namespace {

constexpr int kThumb_px = 360;  ///< width
constexpr int kGap_px = 6;
constexpr int kLabel_px = 56;  ///< column of frame numbers
constexpr int kHead_px = 64;   ///< title and column names
constexpr int kMostZoom = 6;   ///< of the largest wrong piece
constexpr Rgb8 kPaper{24, 24, 28};
constexpr Rgb8 kInk{225, 225, 225};

/// Copies a part of `from` around the middle of a box, each pixel `zoom` times as wide and high, to
/// the columns from `x0` on of `to`. Places beyond the picture repeat its border.
void enlarge(ImageView<const Rgb8> from, const WrongPiece& box, int zoom, int x0, int x1,
             Image<Rgb8>& to) {
  const int left = box.x_px + box.width_px / 2 - (x1 - x0) / (2 * zoom);
  const int top = box.y_px + box.height_px / 2 - to.height() / (2 * zoom);
  for (int y = 0; y < to.height(); ++y) {
    const Rgb8* row = from.row(std::clamp(top + y / zoom, 0, from.size.height - 1));
    for (int x = x0; x < x1; ++x)
      to.row(y)[x] = row[std::clamp(left + (x - x0) / zoom, 0, from.size.width - 1)];
  }
}

/// The surroundings of a wrong piece: left composite, right truth; blank without a piece.
Image<Rgb8> piece_picture(ImageView<const Rgb8> composite, ImageView<const Rgb8> truth,
                          const WrongPiece& piece, Size size) {
  Image<Rgb8> out(size, kPaper);
  if (piece.pixels == 0 || !(composite.size == truth.size)) return out;
  const int half = size.width / 2 - 1;
  const int longest = std::max({piece.width_px, piece.height_px, 1});
  const int zoom = std::clamp(half / (2 * longest), 1, kMostZoom);
  enlarge(composite, piece, zoom, 0, half, out);
  enlarge(truth, piece, zoom, size.width - half, size.width, out);
  return out;
}

}  // namespace

void ContactSheet::add_row(int frame, ImageView<const Rgb8> plate,
                           const render::FrameOutput& output, ImageView<const Rgb8> truth,
                           const std::optional<WrongPiece>& worst) {
  if (rows_.empty()) std::tie(near_m_, far_m_) = report::depth_range(output.warped_depth_m);
  const Size size = output.color.size();
  const Size thumb{kThumb_px, std::max(1, kThumb_px * size.height / size.width)};
  Row row{frame, {}};
  row.pictures.push_back(report::shrunk(plate, thumb));
  row.pictures.push_back(
      report::shrunk(report::depth_picture(output.warped_depth_m, near_m_, far_m_), thumb));
  row.pictures.push_back(report::shrunk(report::key_picture(output.state), thumb));
  row.pictures.push_back(report::shrunk(report::light_picture(output.light), thumb));
  row.pictures.push_back(report::shrunk(output.color, thumb));
  if (!truth.empty()) row.pictures.push_back(report::shrunk(truth, thumb));
  if (!truth.empty() && worst)
    row.pictures.push_back(piece_picture(output.color, truth, *worst, thumb));
  rows_.push_back(std::move(row));
}

Image<Rgb8> ContactSheet::draw() const {
  const std::vector<std::string> names{"input",
                                       "depth",
                                       "key",
                                       "light map",
                                       "composite",
                                       "truth",
                                       "largest wrong piece: composite, truth"};
  if (rows_.empty()) return {};
  const Size thumb = rows_.front().pictures.front().size();
  const int columns = static_cast<int>(rows_.front().pictures.size());
  const int rows = static_cast<int>(rows_.size());
  report::Canvas canvas(
      {kLabel_px + columns * (thumb.width + kGap_px), kHead_px + rows * (thumb.height + kGap_px)},
      kPaper);
  canvas.text({kGap_px, 24}, title_, 17, kInk);
  for (int c = 0; c < columns; ++c) {
    const double middle = kLabel_px + c * (thumb.width + kGap_px) + thumb.width / 2.0;
    canvas.text({middle, kHead_px - 10}, names[static_cast<std::size_t>(c)], 15, kInk,
                report::Align::kCenter);
  }
  for (int r = 0; r < rows; ++r) {
    const Row& row = rows_[static_cast<std::size_t>(r)];
    const int y = kHead_px + r * (thumb.height + kGap_px);
    canvas.text({kLabel_px - 10.0, y + thumb.height / 2.0}, std::to_string(row.frame), 15, kInk,
                report::Align::kRight);
    for (int c = 0; c < static_cast<int>(row.pictures.size()); ++c)
      canvas.picture(kLabel_px + c * (thumb.width + kGap_px), y,
                     row.pictures[static_cast<std::size_t>(c)]);
  }
  return canvas.finish();
}

std::vector<int> spread(int first, int last, int count) {
  std::vector<int> numbers;
  const int available = last - first + 1;
  const int n = std::min(count, available);
  // The middle of each of n equal parts.
  for (int i = 0; i < n; ++i)
    numbers.push_back(first + static_cast<int>((2LL * i + 1) * available / (2LL * n)));
  return numbers;
}

}  // namespace mixrig::output
