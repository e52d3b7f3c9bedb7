// SPDX-License-Identifier: Apache-2.0
// The whole virtual rig, and helpers to run the command on it.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>

#include <arv.h>
#include <nlohmann/json.hpp>

#include "tests/board/bench.h"
#include "tests/board/virtual_rig.h"

namespace mixrig::board {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct UnrefCamera {
  void operator()(ArvGvFakeCamera* camera) const { g_object_unref(camera); }
};

inline Json read_json(const std::string& path) {
  std::ifstream file(path);
  return Json::parse(file, nullptr, false);
}

class Rig : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(rig_.plug());
    ASSERT_TRUE(arv_gv_fake_camera_is_running(gige_.get()));
    rig_.write_config(kConfig);
  }

  /// Verdicts by device and check, such as "color/rate"; prints failed checks.
  std::map<std::string, std::string> diag(const std::string& more = "") {
    fs::remove(kReport);
    const Ran ran = run(std::string("mixrig diag --watch 3 --rig ") + kConfig + " --json " +
                        kReport + " " + more);
    std::printf("%s", ran.text.c_str());
    const Json report = read_json(kReport);
    std::map<std::string, std::string> verdicts;
    if (!report.contains("checks")) {
      ADD_FAILURE() << "no report";
      return verdicts;
    }
    for (const auto& check : report["checks"])
      verdicts[check["device"].get<std::string>() + "/" + check["check"].get<std::string>()] =
          check["verdict"];
    return verdicts;
  }
  /// Devices that have a check with this verdict.
  static std::set<std::string> devices(const std::map<std::string, std::string>& verdicts,
                                       const std::string& wanted) {
    std::set<std::string> found;
    for (const auto& [check, verdict] : verdicts)
      if (verdict == wanted) found.insert(check.substr(0, check.find('/')));
    return found;
  }

  static constexpr const char* kConfig = "/tmp/rig.toml";
  static constexpr const char* kReport = "/tmp/report.json";
  VirtualRig rig_;
  std::unique_ptr<ArvGvFakeCamera, UnrefCamera> gige_{arv_gv_fake_camera_new("127.0.0.1", "GV01")};
};

/// Ticks of a stream by the take's frame number.
inline std::map<int, std::uint64_t> ticks_of(const std::string& take, const std::string& stream) {
  std::ifstream file(take + "/ticks.csv");
  std::map<int, std::uint64_t> ticks;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string frame, name, tick;
    std::getline(fields, frame, ',');
    std::getline(fields, name, ',');
    std::getline(fields, tick, ',');
    if (name == stream) ticks[std::atoi(frame.c_str())] = std::strtoull(tick.c_str(), nullptr, 10);
  }
  return ticks;
}

}  // namespace mixrig::board
