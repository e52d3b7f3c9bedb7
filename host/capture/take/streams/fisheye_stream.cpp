// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/fisheye_stream.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/capture/capture/fisheye.h"
#include "host/capture/take/growing_table.h"
#include "host/capture/take/streams/stored_stream.h"
#include "host/math/config/table.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kMaxTableBytes = std::size_t{512} << 20;

double rate_of(const StreamInfo& stream, const std::vector<FisheyeStamp>& stamps) {
  if (stream.rate_hz > 0 || stamps.size() < 2) return stream.rate_hz;
  return static_cast<double>(stamps.size() - 1) /
         seconds(stamps.back().mid_exposure - stamps.front().mid_exposure);
}

}  // namespace

FisheyeStream::FisheyeStream(const StreamInfo& stream, std::unique_ptr<PictureStream> pictures,
                             std::vector<FisheyeStamp> stamps, const std::string& take)
    : pictures_(std::move(pictures)), stamps_(std::move(stamps)) {
  const auto count = static_cast<std::size_t>(std::max(stream.count, 0));
  if (stamps_.size() != count)
    log_warning("take", fmt::format("{}: the fisheye has {} pictures and {} stamps; what has no "
                                    "partner is left out",
                                    take, count, stamps_.size()));
  stamps_.resize(std::min(stamps_.size(), count));
  rate_hz_ = rate_of(stream, stamps_);
  hold_ = capture::fisheye_hold(rate_hz_);
}

Result<void> FisheyeStream::load(int picture) {
  if (loaded_ == picture) return {};
  loaded_ = -1;
  MIXRIG_TRY(pictures_->read(picture, picture_));
  if (size_ == Size{}) size_ = picture_.size();
  if (picture_.size() != size_)
    return Error{ErrorCode::kData,
                 fmt::format("fisheye picture '{}' is {}x{} but another one of the stream is "
                             "{}x{}: remove [fisheye] from take.toml or replace the picture",
                             pictures_->name(picture), picture_.width(), picture_.height(),
                             size_.width, size_.height)};
  loaded_ = picture;
  return {};
}

Result<void> FisheyeStream::read(capture::Capture& capture) {
  using capture::Stream;
  using capture::StreamStatus;
  const auto after =
      std::upper_bound(stamps_.begin(), stamps_.end(), capture.number,
                       [](int number, const FisheyeStamp& stamp) { return number < stamp.frame; });
  StreamStatus status = StreamStatus::kMissing;
  if (after != stamps_.begin()) {
    const FisheyeStamp& stamp = *std::prev(after);
    status = capture::fisheye_status(stamp.frame == capture.number, capture.mid_exposure,
                                     stamp.mid_exposure, hold_);
  }
  if (status == StreamStatus::kMissing) return capture::lose_fisheye(capture), Result<void>();
  capture.set_status(Stream::kFisheye, status);
  const auto picture = static_cast<int>(std::prev(after) - stamps_.begin());
  MIXRIG_TRY(load(picture));
  if (capture.fisheye.size() != size_) capture.fisheye.reset(size_);
  for (int y = 0; y < size_.height; ++y)
    std::copy_n(std::as_const(picture_).row(y), size_.width, capture.fisheye.row(y));
  capture.fisheye_mid_exposure = std::prev(after)->mid_exposure;
  capture.fisheye_counter = std::prev(after)->counter;
  return {};
}

Result<std::unique_ptr<FisheyeStream>> open_fisheye_stream(const TakeInfo& info, bool unfinished) {
  const std::filesystem::path table = info.root / kFisheyeTable;
  MIXRIG_ASSIGN(const std::string text, config::read_text(table, kMaxTableBytes));
  const std::string_view rows = unfinished ? whole_rows(text) : std::string_view(text);
  MIXRIG_ASSIGN(auto stamps, parse_fisheye_table(rows, table.string()));
  if (unfinished)
    stamps.resize(std::min(stamps.size(), static_cast<std::size_t>(info.fisheye->count)));
  MIXRIG_ASSIGN(auto pictures, open_stored(info.root, *info.fisheye, PixelKind::kRgb8));
  return std::make_unique<FisheyeStream>(*info.fisheye, std::move(pictures), std::move(stamps),
                                         info.path.string());
}

}  // namespace mixrig::take
