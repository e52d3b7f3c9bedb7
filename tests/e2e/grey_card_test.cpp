// SPDX-License-Identifier: Apache-2.0
// mixrig diag on a wall of the virtual studio in place of a grey card.
#include <fstream>
#include <map>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class GreyCard : public CommandTest {};

TEST_F(GreyCard, AWrongTransferIsNamed) {
  const std::string studio = "uri = \"studio:sweep,5,sr3000,,64x48/";
  std::ofstream(path("rig.toml")) << "format = 1\nname = \"made\"\n[[camera]]\nname = \"color\"\n"
                                  << studio << "target\"\ntransfer = \"bt709\"\n[depth]\n"
                                  << studio << "tof\"\n[pan_tilt]\n"
                                  << studio << "head\"\n";
  refusal("diag --rig " + path("rig.toml") + " --grey-card 1,2,3");
  const std::string failed = refusal("diag --no-move --watch 0.5 --grey-card 38,2,22,12 --rig " +
                                     path("rig.toml") + " --json " + path("diag.json"));
  EXPECT_NE(failed.find("mixrig: diag: failed: "), std::string::npos) << failed;
  EXPECT_NE(failed.find("color transfer"), std::string::npos) << failed;
  const nlohmann::json diag = report("diag.json");
  std::map<std::string, nlohmann::json> rows;
  for (const nlohmann::json& row : diag["checks"])
    if (row["device"] == "color") rows[row["check"]] = row;
  EXPECT_EQ(rows["card"]["verdict"], "pass") << diag;
  EXPECT_EQ(rows["transfer"]["verdict"], "fail") << diag;
  const std::string advice = rows["transfer"].value("advice", "");
  EXPECT_NE(advice.find("transfer = \"srgb\""), std::string::npos) << advice;
  EXPECT_EQ(rows["grey"]["verdict"], "fail") << "the wall is warm: " << diag;
}

}  // namespace
}  // namespace mixrig::test
