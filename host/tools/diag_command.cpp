// SPDX-License-Identifier: Apache-2.0
// mixrig diag: health of every device, and what to do.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "host/app/live_source.h"
#include "host/rig/diagnose.h"
#include "host/rig/discover.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string rig;
  double watch_s = 5;
  bool no_move = false, no_network = false;
};

void print(const std::vector<rig::Check>& checks) {
  std::printf("%-6s %-12s %-14s %s\n", "", "device", "check", "measured");
  for (const rig::Check& check : checks) {
    std::printf("%-6s %-12s %-14s %s\n", std::string(name(check.verdict)).c_str(),
                check.device.c_str(), check.what.c_str(), check.value.c_str());
    if (!check.advice.empty()) std::printf("%-6s -> %s\n", "", check.advice.c_str());
  }
}

nlohmann::json to_json(const std::vector<rig::Check>& checks) {
  nlohmann::json rows = nlohmann::json::array();
  for (const rig::Check& check : checks)
    rows.push_back({{"device", check.device},
                    {"check", check.what},
                    {"verdict", std::string(name(check.verdict))},
                    {"value", check.value},
                    {"advice", check.advice}});
  return {{"verdict", std::string(name(rig::worst(checks)))}, {"checks", rows}};
}

Result<nlohmann::json> diag(const Words& words) {
  SystemClock clock;
  rig::RigConfig config;
  if (words.rig.empty()) {
    config = rig::discover({.network = !words.no_network}, clock);
  } else {
    MIXRIG_ASSIGN(config, rig::read_rig(words.rig));
  }
  rig::DiagnoseOptions options;
  options.watch = Duration(static_cast<long>(words.watch_s * 1e9));
  options.move_head = !words.no_move;
  options.playable = app::open_playable;
  const auto checks = rig::diagnose(config, options, clock);
  print(checks);
  return to_json(checks);
}

}  // namespace

void add_diag_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command =
      app.add_subcommand("diag", "open every device, watch it, and judge its health");
  command->add_option("--rig", words->rig, "rig.toml; what is plugged in where absent");
  command->add_option("--watch", words->watch_s, "seconds")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 3600.0));
  command->add_flag("--no-move", words->no_move, "leave the pan-tilt head where it is");
  command->add_flag("--no-network", words->no_network, "do not look for cameras on the network");
  command->callback([&context, words] { context.action = [words] { return diag(*words); }; });
}

}  // namespace mixrig::tools
