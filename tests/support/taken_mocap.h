// SPDX-License-Identifier: Apache-2.0
// The motion capture stream of a studio take: mocap.txt, with the true time of each sample.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/unit/mocap/natnet_packets.h"

namespace mixrig::test {

struct TakenSample {
  int number = 0;      ///< frame number of the system; lost frames leave a gap
  double time_s = 0;   ///< time of the take at which the pose is true
  double stamp_s = 0;  ///< time on the system's clock
  float position_m[3] = {}, rotation_xyzw[4] = {};  ///< pose of the body; z up
};

/// truth/rig.json says how the system's clock runs. Empty where a file is missing.
inline std::vector<TakenSample> read_taken_mocap(const std::filesystem::path& take) {
  std::ifstream truth(take / "truth" / "rig.json"), lines(take / "mocap.txt");
  const auto rig = nlohmann::json::parse(truth, nullptr, false);
  std::vector<TakenSample> samples;
  if (!rig.contains("mocap")) return samples;
  const double offset_s = rig["mocap"]["clock_offset_s"], drift = rig["mocap"]["clock_drift"],
               delay_s = rig["mocap"]["delay_s"], rate_hz = rig["mocap"]["rate_hz"];
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    TakenSample sample;
    words >> sample.stamp_s;
    for (float& value : sample.position_m) words >> value;
    for (float& value : sample.rotation_xyzw) words >> value;
    sample.time_s = (sample.stamp_s - offset_s) / (1 + drift) - delay_s;
    sample.number = 1000 + static_cast<int>(std::lround(sample.time_s * rate_hz));
    samples.push_back(sample);
  }
  return samples;
}

/// A packet of NatNet 3.0 with one body and nothing else.
inline std::vector<std::byte> packet_of(const TakenSample& sample, int body) {
  stream::PacketWriter w;
  w.put(std::int32_t{sample.number});
  w.put(std::int32_t{0}).put(std::int32_t{0}).put(std::int32_t{1});  // sets, other markers, bodies
  w.put(std::int32_t{body});
  for (const float value : sample.position_m) w.put(value);
  for (const float value : sample.rotation_xyzw) w.put(value);
  w.put(0.0002F).put(std::int16_t{1});  // mean error; tracked
  for (int section = 0; section < 4; ++section) w.put(std::int32_t{0});
  w.put(std::uint32_t{0}).put(std::uint32_t{0}).put(sample.stamp_s);
  for (int stamp = 0; stamp < 3; ++stamp) w.put(std::uint64_t{0});
  w.put(std::int16_t{0}).put(std::int32_t{0});
  return w.packet(7);
}

}  // namespace mixrig::test
