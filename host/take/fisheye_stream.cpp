// SPDX-License-Identifier: Apache-2.0
#include "host/take/fisheye_stream.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/config/table.h"
#include "host/take/stored_stream.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kMaxTableBytes = std::size_t{64} << 20;
constexpr double kRepeatedPeriods = 1.5;

/// Of the stream, by its rate or by its stamps; 0 where neither tells.
double period_s(const StreamInfo& stream, const std::vector<FisheyeStamp>& stamps) {
  if (stream.rate_hz > 0) return 1 / stream.rate_hz;
  if (stamps.size() < 2) return 0;
  return seconds(stamps.back().mid_exposure - stamps.front().mid_exposure) /
         static_cast<double>(stamps.size() - 1);
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
  const double age_s = std::min(kRepeatedPeriods * period_s(stream, stamps_), 1e6);
  longest_age_ = Duration(std::llround(age_s * 1e9));
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
    if (stamp.frame == capture.number)
      status = StreamStatus::kFresh;
    else if (capture.mid_exposure - stamp.mid_exposure <= longest_age_)
      status = StreamStatus::kRepeated;
  }
  capture.set_status(Stream::kFisheye, status);
  if (status == StreamStatus::kMissing) {
    capture::clear_fisheye(capture);
    return {};
  }
  const auto picture = static_cast<int>(std::prev(after) - stamps_.begin());
  MIXRIG_TRY(load(picture));
  if (capture.fisheye.size() != size_) capture.fisheye.reset(size_);
  for (int y = 0; y < size_.height; ++y)
    std::copy_n(std::as_const(picture_).row(y), size_.width, capture.fisheye.row(y));
  capture.fisheye_mid_exposure = std::prev(after)->mid_exposure;
  capture.fisheye_counter = std::prev(after)->counter;
  return {};
}

Result<std::unique_ptr<FisheyeStream>> open_fisheye_stream(const TakeInfo& info) {
  const std::filesystem::path table = info.root / kFisheyeTable;
  MIXRIG_ASSIGN(const std::string text, config::read_text(table, kMaxTableBytes));
  MIXRIG_ASSIGN(auto stamps, parse_fisheye_table(text, table.string()));
  MIXRIG_ASSIGN(auto pictures, open_stored(info.root, *info.fisheye, PixelKind::kRgb8));
  return std::make_unique<FisheyeStream>(*info.fisheye, std::move(pictures), std::move(stamps),
                                         info.path.string());
}

}  // namespace mixrig::take
