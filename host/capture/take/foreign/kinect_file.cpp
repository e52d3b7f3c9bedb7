// SPDX-License-Identifier: Apache-2.0
// Recordings of k4arecorder and of Orbbec's programs: Matroska with colour as MJPEG, depth as raw
// pictures of 16 bits, big-endian, in millimetres along the axis, and the factory calibration.
#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "host/capture/take/foreign/azure_calibration.h"
#include "host/capture/take/foreign/foreign_take.h"
#include "host/capture/take/foreign/mapped_file.h"
#include "host/capture/take/streams/matroska_tracks.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr const char* kCalibrationName = "calibration.json";

const MatroskaTrack* track_of(const MatroskaContents& contents, const char* name) {
  const auto at = std::ranges::find(contents.tracks, name, &MatroskaTrack::name);
  return at == contents.tracks.end() ? nullptr : &*at;
}

Result<void> check_codecs(const MatroskaTrack* color, const MatroskaTrack* depth) {
  if (color == nullptr || depth == nullptr)
    return Error{ErrorCode::kData, "has no track COLOR or no track DEPTH: a take has both"};
  if (color->codec != "MJPEG" || depth->codec != kRawGray16)
    return Error{ErrorCode::kUnsupported,
                 fmt::format("its colour is {}, its depth {}: record colour as MJPEG and depth as "
                             "b16g, as k4arecorder does",
                             color->codec, depth->codec)};
  return {};
}

/// Big-endian samples. Returns whether the bytes are those of a picture of this size.
bool read_samples(std::span<const std::uint8_t> bytes, Image<std::uint16_t>& steps) {
  if (bytes.size() < 2 * steps.size().area()) return false;
  for (int y = 0; y < steps.height(); ++y) {
    const std::uint8_t* from = bytes.data() + 2 * static_cast<std::size_t>(y) * steps.width();
    for (int x = 0; x < steps.width(); ++x)
      steps.row(y)[x] = static_cast<std::uint16_t>(from[2 * x] << 8 | from[2 * x + 1]);
  }
  return true;
}

Result<void> read_calibration(const MatroskaContents& contents, Size color_px, Size depth_px,
                              TakeInfo& info) {
  const auto file = std::ranges::find(contents.attachments, kCalibrationName,
                                      &decltype(contents.attachments)::value_type::first);
  if (file == contents.attachments.end())
    return Error{ErrorCode::kData, "has no attachment calibration.json: the cameras are not known"};
  const std::string_view text(reinterpret_cast<const char*>(file->second.data()),
                              file->second.size());
  MIXRIG_ASSIGN(const AzureCameras cameras, parse_azure_calibration(text, color_px, depth_px));
  info.target = cameras.color, info.tof = cameras.depth;
  info.target_from_tof = cameras.color_from_depth;
  return {};
}

Result<void> add_pictures(const MatroskaContents& contents, const MatroskaTrack& color,
                          const MatroskaTrack& depth, ForeignTake& take) {
  Image<std::uint16_t> steps(depth.size_px);
  int cut = 0;
  for (const MatroskaBlock& block : contents.blocks) {
    const double time_s = static_cast<double>(block.ticks) * contents.tick_s;
    if (block.track == color.number)
      MIXRIG_TRY(take.add(ForeignTake::Stream::kColor, time_s, block.bytes));
    if (block.track != depth.number) continue;
    if (read_samples(block.bytes, steps))
      MIXRIG_TRY(take.add_depth(time_s, steps.view()));
    else
      ++cut;
  }
  if (contents.is_cut) take.told.lost.push_back("the end of the file, which is cut off");
  if (cut > 0) take.told.lost.push_back(fmt::format("{} depth pictures that are cut off", cut));
  return {};
}

Result<void> read_contents(const MatroskaContents& contents, ForeignTake& take) {
  const MatroskaTrack *color = track_of(contents, "COLOR"), *depth = track_of(contents, "DEPTH");
  MIXRIG_TRY(check_codecs(color, depth));
  constexpr int kMostSide_px = 16384;
  if (depth->size_px.empty() ||
      std::max(depth->size_px.width, depth->size_px.height) > kMostSide_px)
    return Error{ErrorCode::kFormat, "does not state the size of its depth: it is damaged"};
  MIXRIG_TRY(read_calibration(contents, color->size_px, depth->size_px, take.info));
  MIXRIG_TRY(add_pictures(contents, *color, *depth, take));
  for (const MatroskaTrack& track : contents.tracks)
    if (&track != color && &track != depth)
      take.told.lost.push_back("the pictures of its track " + track.name);
  take.told.lost.push_back("motion samples, where it has them");
  return {};
}

}  // namespace

bool is_kinect_file(const fs::path& source) {
  std::error_code error;
  return source.extension() == ".mkv" && fs::is_regular_file(source, error);
}

Result<void> read_kinect_file(const fs::path& source, ForeignTake& take) {
  MIXRIG_ASSIGN(const MappedFile file, MappedFile::open(source));
  take.told.kind = "a recording of an Azure Kinect or Orbbec camera";
  take.info.depth_unit_m = 0.001;
  return named(source, file.if_whole(read_contents(parse_contents(file.bytes()), take)));
}

}  // namespace mixrig::take
