// SPDX-License-Identifier: Apache-2.0
// Any bytes as ticks.csv, pan_tilt.csv, lens.csv, fisheye.csv and bracket.csv; accepted rows of the
// lens, the fisheye and the bracket are written and read again.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "host/capture/take/bracket_files.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(take_tables) {
  using namespace mixrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static_cast<void>(take::parse_ticks(text, "ticks.csv"));
  static_cast<void>(take::parse_pan_tilt(text, "pan_tilt.csv"));
  static_cast<void>(take::parse_people(text, "truth/people.csv"));
  static_cast<void>(take::parse_true_lens(text, "truth/lens.csv", {64, 48}));
  if (const auto samples = take::parse_lens_samples(text, "lens.csv")) {
    std::string again = take::kLensHeader;
    for (const capture::LensSample& sample : *samples) {
      again += take::lens_row(sample);
      const auto at = capture::lens_at(*samples, sample.time);
      if (!at || !(*at == sample.at)) std::abort();
    }
    static_cast<void>(capture::lens_at(*samples, HostTime{}));
    const auto read = take::parse_lens_samples(again, "lens.csv");
    if (!read || read->size() != samples->size()) std::abort();
  }
  if (const auto rows = take::parse_bracket_table(text, "bracket.csv")) {
    const auto read = take::parse_bracket_table(take::bracket_text(*rows), "bracket.csv");
    if (!read || *read != *rows) std::abort();
  }
  const auto stamps = take::parse_fisheye_table(text, "fisheye.csv");
  if (!stamps) return 0;
  std::string again = "picture,frame,counter,mid_exposure_ns\n";
  int picture = 0;
  for (const take::FisheyeStamp& stamp : *stamps) again += take::fisheye_row(++picture, stamp);
  const auto read = take::parse_fisheye_table(again, "fisheye.csv");
  if (!read || read->size() != stamps->size()) std::abort();
  return 0;
}
