// SPDX-License-Identifier: Apache-2.0
// The first start of GStreamer by a user lists all plug-ins for up to a minute: a command says so.
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class FirstStart : public CommandTest {
 protected:
  /// What a run with a stream writes, with this list of GStreamer's plug-ins.
  std::string run_with_stream(const std::string& list) const {
    const std::string line = "GST_REGISTRY_1_0=" + list + " " MIXRIG_COMMAND " run " +
                             path("take/scene.toml") + " --source take:" + path("take") +
                             " --backend cpu --stream " + path("a.mp4") + " >" + path("said") +
                             " 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0);
    std::ifstream file(path("said"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(FirstStart, SaysWhyItTakesLongAndTheNextOneDoesNot) {
  ASSERT_EQ(studio("take", "--plain --frames 8 --size 64x48"), 0);
  const std::string words = "GStreamer lists its plug-ins";
  EXPECT_NE(run_with_stream(path("list")).find(words), std::string::npos);
  std::filesystem::remove(path("a.mp4"));
  EXPECT_EQ(run_with_stream(path("list")).find(words), std::string::npos);
}

}  // namespace
}  // namespace mixrig::test
