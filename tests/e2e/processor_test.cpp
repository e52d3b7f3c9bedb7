// SPDX-License-Identifier: Apache-2.0
// The command on a processor older than it was built for, emulated.
#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "hal/base/cpu_level.h"

namespace mixrig::test {
namespace {

struct Outcome {
  int status = -1;
  std::string output;
};
Outcome run(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return outcome;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
    outcome.output.push_back(static_cast<char>(c));
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

TEST(Processor, is_named_in_the_version) {
  const Outcome outcome = run(MIXRIG_COMMAND " --version");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find(", " MIXRIG_CPU_LEVEL " ("), std::string::npos) << outcome.output;
}

TEST(Processor, an_older_one_than_built_for_is_reported_in_one_line) {
  const std::string emulator = "/usr/bin/qemu-x86_64-static", level = MIXRIG_CPU_LEVEL;
  if (!std::filesystem::exists(emulator))
    GTEST_SKIP() << "no " << emulator << ": scripts/setup arm64 installs it";
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the emulator has no room for a sanitizer's shadow memory";
#endif
  // Nehalem has all of x86-64-v2 and nothing of x86-64-v3.
  const Outcome outcome =
      run("timeout 120 " + emulator + " -cpu Nehalem " MIXRIG_COMMAND " --version");
  if (level == "x86-64-v3" || level == "x86-64-v4") {
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_EQ(outcome.output, "mixrig: this program is built for " + level +
                                  " and this processor is older: build it on this machine, or "
                                  "with MIXRIG_MARCH=x86-64\n");
  } else {
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find(level), std::string::npos) << outcome.output;
  }
}

}  // namespace
}  // namespace mixrig::test
