// SPDX-License-Identifier: Apache-2.0
// The fisheye stream of a take: pictures at their own rate, and fisheye.csv with their stamps.
// Private to this module.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/capture/take/streams/picture_stream.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

inline constexpr const char* kFisheyeTable = "fisheye.csv";
inline constexpr const char* kFisheyeHeader = "picture,frame,counter,mid_exposure_ns\n";

/// A row of fisheye.csv. Row k (from 0) describes picture k of the stream.
struct FisheyeStamp {
  int frame = 0;              ///< number of the first capture with the picture, from 1
  std::uint64_t counter = 0;  ///< the camera's counter
  HostTime mid_exposure{};    ///< on the clock of the plates
};

/// Parses rows "picture,frame,counter,mid_exposure_ns" after a header line. Pictures count from 1,
/// frames and times grow. Pure. Errors: kFormat (name:line: ...).
Result<std::vector<FisheyeStamp>> parse_fisheye_table(std::string_view text,
                                                      const std::string& name);
std::string fisheye_row(int picture, const FisheyeStamp& stamp);

/// Gives each capture its fisheye picture. Holds one decoded picture. Not thread-safe.
class FisheyeStream {
 public:
  /// `pictures` has `stream.count` pictures; those without a stamp, or a stamp without a picture,
  /// are left out with a warning.
  FisheyeStream(const StreamInfo& stream, std::unique_ptr<PictureStream> pictures,
                std::vector<FisheyeStamp> stamps, const std::string& take);

  /// Sets picture, stamp, counter and status of the fisheye of capture `capture.number`, whose
  /// mid-exposure is set, by capture::fisheye_status(): fresh in the frame of the picture's row.
  /// Errors: those of the stream; kData for a picture of another size than the first one that was
  /// read.
  Result<void> read(capture::Capture& capture);
  /// Returns the rate of the stream, else one by its stamps; 0 if neither gives it.
  double rate_hz() const { return rate_hz_; }

 private:
  Result<void> load(int picture);

  std::unique_ptr<PictureStream> pictures_;
  std::vector<FisheyeStamp> stamps_;
  double rate_hz_ = 0;
  Duration hold_{};
  Image<Rgb8> picture_;
  Size size_{};
  int loaded_ = -1;  ///< index of `picture_`
};

/// Opens the stream and its table; of an `unfinished` take, whose count is that of whole pictures,
/// further rows are left out. Errors: kNotFound, kFormat, kUnsupported.
Result<std::unique_ptr<FisheyeStream>> open_fisheye_stream(const TakeInfo& info,
                                                           bool unfinished = false);

}  // namespace mixrig::take
