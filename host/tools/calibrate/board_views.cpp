// SPDX-License-Identifier: Apache-2.0
#include "host/tools/calibrate/board_views.h"

#include <algorithm>
#include <filesystem>

#include <malloc.h>

#include "hal/base/order_statistics.h"
#include "hal/base/parallel.h"
#include "host/calibrate/board/suggest_board.h"
#include "host/math/image_io/image_io.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

namespace fs = std::filesystem;
using calibration::BoardSpec;

/// Result for one file.
struct Seen {
  Size size_px;
  Image<std::uint8_t> gray;  ///< until it is added to the brightest picture
  std::optional<calibration::BoardView> board;
  std::optional<Error> error;
};

/// Grey of a picture; 16-bit grey pictures (of ToF cameras) are stretched to 8.
Result<Image<std::uint8_t>> read_gray(const fs::path& path) {
  Image<std::uint16_t> deep;
  if (path.extension() == ".png" && image_io::read_gray16(path, deep))
    return calibration::gray_of(deep);
  Image<Rgb8> color;
  MIXRIG_TRY(image_io::read_rgb8(path, color));
  return calibration::gray_of(color);
}

Seen look_at(const std::string& path, const BoardSpec& board) {
  Seen seen;
  auto gray = read_gray(path);
  if (!gray) return seen.error = gray.error(), seen;
  seen.size_px = gray->size();
  auto view = calibration::detect_board(*gray, board);
  if (!view) return seen.error = view.error(), seen;
  seen.board = std::move(*view);
  seen.gray = std::move(*gray);
  return seen;
}

std::vector<Seen> look_at_all(const std::vector<std::string>& images, const BoardSpec& board,
                              calibration::BrightestPicture& brightest) {
  std::vector<Seen> seen(images.size());
  Progress bar("finding the board", static_cast<int>(seen.size()));
  // One picture a thread at a time; the bar belongs to the caller's thread.
  Crew crew;
  const int batch = crew.threads();
  for (int from = 0; from < static_cast<int>(seen.size()); from += batch) {
    const int count = std::min(batch, static_cast<int>(seen.size()) - from);
    crew.rows(count, 1, [&](int begin, int end) {
      for (int i = from + begin; i < from + end; ++i)
        seen[static_cast<std::size_t>(i)] = look_at(images[static_cast<std::size_t>(i)], board);
    });
    for (int i = from; i < from + count; ++i) {
      brightest.add(seen[static_cast<std::size_t>(i)].gray.view());
      seen[static_cast<std::size_t>(i)].gray = {};
    }
    bar.step(from + count);
  }
  return seen;
}

Error no_board(const std::vector<std::string>& images, const BoardSpec& board) {
  const auto first = read_gray(images.front());
  const auto meant = first ? calibration::suggest_board(*first, board) : std::nullopt;
  return {ErrorCode::kData,
          "no picture shows the board " + calibration::board_text(board) +
              (meant ? ", but " + images.front() + " shows " + board_text(*meant) +
                           ": give --board " + board_text(*meant)
                     : std::string(": check its kind, inner corners and light; a checkerboard must "
                                   "be seen whole"))};
}

}  // namespace

void keep_freed_memory() {
  constexpr int kLargest_bytes = 32 << 20, kKept_bytes = 1 << 30, kGrow_bytes = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargest_bytes);
  mallopt(M_TRIM_THRESHOLD, kKept_bytes);
  mallopt(M_TOP_PAD, kGrow_bytes);
}

Result<BoardViews> collect_views(const std::vector<std::string>& images, const BoardSpec& board) {
  keep_freed_memory();
  BoardViews all;
  const auto seen = look_at_all(images, board, all.brightest);
  int older = 0, today = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::string name = fs::path(images[i]).filename().string();
    if (seen[i].error) return *seen[i].error;
    if (i == 0) all.size_px = seen[i].size_px;
    if (seen[i].size_px != all.size_px) {
      const auto text = [](Size s) {
        return std::to_string(s.width) + "x" + std::to_string(s.height);
      };
      return Error{ErrorCode::kData, images[i] + ": is " + text(seen[i].size_px) +
                                         ", the first picture " + text(all.size_px) +
                                         ": give the pictures of one camera"};
    }
    if (!seen[i].board) {
      all.without.push_back(name);
      continue;
    }
    all.views.push_back({name, *seen[i].board});
    if (const auto white = seen[i].board->first_is_white) ++(*white ? older : today);
  }
  all.older_layout = board.kind == calibration::BoardKind::kCharuco && older > today;
  if (all.views.empty()) return no_board(images, board);
  return all;
}

Result<void> check_board(const std::vector<std::string>& images, const BoardSpec& board,
                         const BoardViews& all) {
  if (board.kind == calibration::BoardKind::kCheckerboard) return {};
  std::vector<double> shares;
  for (const auto& view : all.views) {
    Eigen::Vector2d low = view.board.px.front(), high = low;
    for (const auto& p : view.board.px) low = low.cwiseMin(p), high = high.cwiseMax(p);
    shares.push_back(calibration::homography_misfit_px(view.board, board) / (high - low).norm());
  }
  constexpr double kWrongShare = 0.05;
  if (upper_median(shares) < kWrongShare) return {};
  const auto at = std::find_if(images.begin(), images.end(), [&](const std::string& path) {
    return fs::path(path).filename() == all.views.front().name;
  });
  const auto image = read_gray(*at);
  const auto meant = image ? calibration::suggest_board(*image, board) : std::nullopt;
  return Error{ErrorCode::kData, "the board is not " + calibration::board_text(board) +
                                     ": its points lie in other places in every view" +
                                     (meant ? ": give --board " + board_text(*meant)
                                            : std::string(": count its squares"))};
}

}  // namespace mixrig::tools
