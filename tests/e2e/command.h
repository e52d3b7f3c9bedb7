// SPDX-License-Identifier: Apache-2.0
// Runs the `mixrig` program in a temporary folder.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mixrig::test {

/// Numbers of one column of a CSV file with a header.
inline std::vector<double> column(const std::string& file, int index) {
  std::ifstream in(file);
  std::vector<double> values;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i <= index; ++i) std::getline(cells, cell, ',');
    values.push_back(std::stod(cell));
  }
  return values;
}

class CommandTest : public ::testing::Test {
 protected:
  CommandTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "mixrig-e2e-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~CommandTest() override { std::filesystem::remove_all(folder_); }

  /// Exit status of `mixrig WORDS`, its output kept out of the log unless it fails.
  int mixrig(const std::string& words) const { return shell(MIXRIG_COMMAND " " + words); }
  /// Renders a studio take into folder `name`. A take that another test of this build has rendered
  /// with the same options is copied.
  int studio(const std::string& name, const std::string& options) const {
    return shell(std::string(MIXRIG_STUDIO_TAKE " " MIXRIG_COMMAND " ") + path(name) + " " +
                 options);
  }
  /// Runs a command that must fail, and returns its output.
  std::string refusal(const std::string& words) const {
    const std::string line =
        std::string(MIXRIG_COMMAND) + " " + words + " >" + path("refusal") + " 2>&1";
    EXPECT_NE(std::system(line.c_str()), 0) << words;
    std::ifstream file(path("refusal"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  nlohmann::json report(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return nlohmann::json::parse(file);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;

 private:
  int shell(const std::string& line) const {
    const int status = std::system((line + " >" + path("log") + " 2>&1").c_str());
    if (status != 0) {
      std::ifstream log(path("log"));
      ADD_FAILURE() << line << "\n" << std::string(std::istreambuf_iterator<char>(log), {});
    }
    return status;
  }
};

}  // namespace mixrig::test
