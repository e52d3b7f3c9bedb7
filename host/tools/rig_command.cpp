// SPDX-License-Identifier: Apache-2.0
// mixrig rig init: a rig.toml of what is plugged in.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "host/rig/discover.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string out = "rig.toml";
  bool force = false, no_network = false;
};

Result<nlohmann::json> init(const Words& words) {
  namespace fs = std::filesystem;
  if (fs::exists(words.out) && !words.force)
    return Error{ErrorCode::kUsage,
                 "'" + words.out + "' is there already: name another file, or --force"};
  SystemClock clock;
  const rig::RigConfig config = rig::discover({.network = !words.no_network}, clock);
  const fs::path partial = words.out + ".partial";
  {
    std::ofstream file(partial);
    file << rig::rig_text(config);
    if (!file.flush()) return Error{ErrorCode::kIo, "cannot write '" + partial.string() + "'"};
  }
  std::error_code error;
  fs::rename(partial, words.out, error);
  if (error) return system_error(ErrorCode::kIo, "cannot write '" + words.out + "'", error.value());
  std::printf("%s: %zu cameras, %s depth camera, %s trigger, %s pan-tilt unit\n", words.out.c_str(),
              config.cameras.size(), config.depth ? "a" : "no",
              config.trigger_uri.empty() ? "no" : "a", config.pan_tilt_uri.empty() ? "no" : "a");
  return nlohmann::json{{"cameras", config.cameras.size()},
                        {"depth", config.depth.has_value()},
                        {"trigger", config.trigger_uri},
                        {"pan_tilt", config.pan_tilt_uri}};
}

}  // namespace

void add_rig_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* rig = app.add_subcommand("rig", "describe the devices of a rig");
  rig->require_subcommand(1);
  CLI::App* command = rig->add_subcommand("init", "write a rig.toml of what is plugged in");
  command->add_option("OUT", words->out, "file to write")->capture_default_str();
  command->add_flag("--force", words->force, "replace the file");
  command->add_flag("--no-network", words->no_network, "do not look for cameras on the network");
  command->callback([&context, words] { context.action = [words] { return init(*words); }; });
}

}  // namespace mixrig::tools
