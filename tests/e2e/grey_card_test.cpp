// SPDX-License-Identifier: Apache-2.0
// mixrig diag on a wall of the virtual studio in place of a grey card.
#include <fstream>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class GreyCard : public CommandTest {
 protected:
  /// The row of a check.
  nlohmann::json judged(const std::string& lines, const std::string& what) {
    const std::string studio = "uri = \"studio:sweep,5,sr3000,,64x48/";
    std::ofstream(path("rig.toml")) << "format = 1\nname = \"made\"\n[[camera]]\nname = \"color\"\n"
                                    << studio << "target\"\n"
                                    << lines << "[depth]\n"
                                    << studio << "tof\"\n[pan_tilt]\n"
                                    << studio << "head\"\n";
    EXPECT_EQ(mixrig("diag --no-move --watch 0.5 --grey-card 40,4,16,10 --rig " + path("rig.toml") +
                     " --json " + path("diag.json")),
              0);
    for (const nlohmann::json& row : report("diag.json")["checks"])
      if (row["device"] == "color" && row["check"] == what) return row;
    ADD_FAILURE() << report("diag.json");
    return {};
  }
};

TEST_F(GreyCard, AWrongTransferIsNamedAndTheRightOnePasses) {
  const nlohmann::json wrong = judged("transfer = \"bt709\"\n", "transfer");
  EXPECT_EQ(wrong["verdict"], "fail");
  EXPECT_NE(wrong["advice"].get<std::string>().find("transfer = \"srgb\""), std::string::npos)
      << wrong;
  EXPECT_EQ(judged("", "transfer")["verdict"], "pass");
  refusal("diag --grey-card 1,2,3");
}

}  // namespace
}  // namespace mixrig::test
