// SPDX-License-Identifier: Apache-2.0
// Maps the frames of a recording of GenicamTake to those of the take that was played, and its
// truth.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>

#include "tests/support/genicam/genicam_take.h"

namespace mixrig::test {

/// Frames of the played take that make up one recorded frame.
struct SentFrame {
  int color = 0, depth = 0;  ///< 0: none
};

/// Reads the counters in ticks.csv of the recording; `depth` is 0 in frames without depth.
inline std::map<int, SentFrame> sent_frames(const std::filesystem::path& recording,
                                            const GenicamTake& cameras) {
  std::map<int, SentFrame> frames;
  std::ifstream file(recording / "ticks.csv");
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string frame, stream, tick, counter;
    std::getline(cells, frame, ','), std::getline(cells, stream, ',');
    std::getline(cells, tick, ','), std::getline(cells, counter, ',');
    const int number = std::atoi(frame.c_str());
    if (number < 1) continue;
    (stream == "tof" ? frames[number].depth : frames[number].color) =
        cameras.frame_of(std::strtoull(counter.c_str(), nullptr, 10));
  }
  return frames;
}

/// [target], [tof] and [target_from_tof] of a rig.toml, copied from a studio take.
inline std::string camera_tables(const std::filesystem::path& take) {
  std::ifstream file(take / "take.toml");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto begin = text.find("[target]");
  return std::regex_replace(text.substr(begin, text.find("[pose]") - begin),
                            std::regex("view = .*"), "");
}

/// [world_from_target] of a rig.toml: the first pose of a take.
inline std::string world_table(const std::filesystem::path& take) {
  std::ifstream file(take / "poses.txt");
  double t = 0, p[3], q[4];
  file >> t >> p[0] >> p[1] >> p[2] >> q[0] >> q[1] >> q[2] >> q[3];
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  char text[800];
  std::snprintf(text, sizeof text,
                "[world_from_target]\nrotation = [[%.15g, %.15g, %.15g], [%.15g, %.15g, %.15g], "
                "[%.15g, %.15g, %.15g]]\ntranslation_m = [%.15g, %.15g, %.15g]\n",
                1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p[0], p[1],
                p[2]);
  return text;
}

/// Copies the truth of the played take into the recording, under the recording's frame numbers.
inline void give_truth(const std::filesystem::path& take, const std::filesystem::path& recording,
                       const GenicamTake& cameras) {
  namespace fs = std::filesystem;
  for (const auto& [number, from] : sent_frames(recording, cameras))
    for (const char* kind : {"depth", "matte", "light", "composite", "labels"}) {
      char there[64], here[64];
      std::snprintf(there, sizeof there, "truth/%s/%06d.png", kind, from.color);
      std::snprintf(here, sizeof here, "truth/%s/%06d.png", kind, number);
      fs::create_directories((recording / here).parent_path());
      fs::copy(take / there, recording / here);
    }
  std::ofstream(recording / "take.toml", std::ios::app)
      << "\n[truth]\npath = \"truth\"\ndepth_unit_m = 0.00025\n";
}

}  // namespace mixrig::test
