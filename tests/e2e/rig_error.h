// SPDX-License-Identifier: Apache-2.0
// Compares the poses in a report of `mixrig calibrate rig` with truth.json (report_pose.h), and
// runs commands that must be refused.
#pragma once

#include <fstream>
#include <iterator>

#include "tests/e2e/command.h"
#include "tests/support/report_pose.h"

namespace mixrig::test {

inline std::string text_of_file(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Removes the table [fisheye] of a take.toml.
inline void leave_out_fisheye(const std::string& take_toml) {
  const std::string text = text_of_file(take_toml);
  const std::size_t begin = text.find("[fisheye]"), end = text.find("\n[", begin);
  ASSERT_NE(end, std::string::npos);
  std::ofstream(take_toml) << text.substr(0, begin) << text.substr(end + 1);
}

class RefusingCommandTest : public CommandTest {
 protected:
  /// Exit status of a command that is expected to fail; `error_line` gets its error line.
  int refused(const std::string& words, std::string& error_line) const {
    const std::string line =
        std::string(MIXRIG_COMMAND) + " " + words + " >/dev/null 2>" + path("err");
    const int status = std::system(line.c_str());
    error_line = text_of_file(path("err"));
    return WEXITSTATUS(status);
  }
};

}  // namespace mixrig::test
