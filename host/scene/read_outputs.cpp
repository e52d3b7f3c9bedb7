// SPDX-License-Identifier: Apache-2.0
#include "host/scene/read_outputs.h"

#include <array>
#include <cmath>

namespace mixrig::scene {
namespace {

constexpr std::array<const char*, 7> kPictures{"fill",  "key",      "depth", "fill+key",
                                               "alpha", "2d+depth", "stereo"};
constexpr std::array<const char*, 5> kCodecs{"auto", "ffv1", "h264", "prores", "raw"};

}  // namespace

StreamOut read_stream_out(const config::Table& table, const std::filesystem::path& folder) {
  StreamOut out;
  out.uri = table.text_or("uri", "");
  if (out.uri.empty())
    table.fail("uri",
               "is missing: give srt://HOST:PORT, rtp://HOST:PORT, shm://PATH, v4l2://DEVICE, or a "
               "file .mkv, .mov or .mp4");
  else if (out.uri.find("://") == std::string::npos)
    out.uri = config::path_at(table, "uri", folder).string();
  out.picture = static_cast<StreamOut::Picture>(
      table.one_of("picture", {kPictures.begin(), kPictures.end()}, 0));
  out.codec =
      static_cast<StreamOut::Codec>(table.one_of("codec", {kCodecs.begin(), kCodecs.end()}, 0));
  out.eye_m = 1e-3 * table.number_or("eye_mm", 1e3 * out.eye_m, {1, 1000});
  out.screen_m = table.number_or("screen_m", out.screen_m, {0.1, 1000});
  out.most_disparity_pct = table.number_or("most_disparity_pct", out.most_disparity_pct, {0, 10});
  out.near_m = table.number_or("near_m", out.near_m, {0.01, 1000});
  out.far_m = table.number_or("far_m", out.far_m, {0.01, 1000});
  if (out.near_m >= out.far_m) table.fail("near_m", "must be less than far_m");
  return out;
}

std::optional<FocusSettings> read_focus(const config::Table& table) {
  if (!table.present()) return std::nullopt;
  FocusSettings focus;
  const bool by_pixel = table.has("pixel");
  if (by_pixel) {
    const auto at = table.numbers("pixel", 2, 2, {0, 16384});
    focus.pixel = {static_cast<int>(std::lround(at[0])), static_cast<int>(std::lround(at[1]))};
  }
  if (by_pixel == table.has("distance_m"))
    table.fail("distance_m", "give either distance_m or pixel, not both");
  focus.distance_m = table.number_or("distance_m", 0, {0.01, 1e4});
  focus.f_number = table.number_or("f_number", focus.f_number, {0.5, 128});
  focus.sensor_width_mm = table.number_or("sensor_width_mm", focus.sensor_width_mm, {0.1, 1000});
  focus.most_blur_pct = table.number_or("most_blur_pct", focus.most_blur_pct, {0.1, 15});
  return focus;
}

}  // namespace mixrig::scene
