// SPDX-License-Identifier: Apache-2.0
// mixrig rig init: a rig.toml of what is plugged in.
#include <cstdio>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "host/capture/live/rig/discover.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"

namespace mixrig::tools {
namespace {

struct RigFileArguments {
  std::string out = "rig.toml";
  bool force = false, no_network = false;
};

constexpr const char* kUdevAdvice =
    "install 70-mixrig.rules of the package or of board/udev in /etc/udev/rules.d, and join the "
    "groups video, dialout and plugdev";

bool is_empty(const live::RigConfig& config) {
  return config.cameras.empty() && !config.depth && config.trigger_uri.empty() &&
         config.pan_tilt_uri.empty();
}

Result<nlohmann::json> init(const RigFileArguments& arguments) {
  if (std::filesystem::exists(arguments.out) && !arguments.force)
    return Error{ErrorCode::kUsage,
                 "'" + arguments.out + "' exists: name another file, or use --force"};
  SystemClock clock;
  const live::RigConfig config =
      live::discover({.network = !arguments.no_network}, source_kinds().devices, clock);
  if (is_empty(config))
    return Error{ErrorCode::kDevice,
                 std::string("no device found, so no rig was written; looked for: cameras at "
                             "/dev/video*, USB depth cameras") +
                     (arguments.no_network ? "" : ", GigE Vision cameras on the network") +
                     ", a trigger board and a pan-tilt unit at /dev/ttyACM* and /dev/ttyUSB*; "
                     "connect one, and see that your user may open it (" +
                     kUdevAdvice + ")"};
  MIXRIG_TRY(write_file(arguments.out, live::rig_text(config)));
  const int depth = (config.depth ? 1 : 0) + (config.depth2 ? 1 : 0);
  std::printf("%s: %zu cameras, %d depth cameras, %s trigger, %s pan-tilt unit\n",
              arguments.out.c_str(), config.cameras.size(), depth,
              config.trigger_uri.empty() ? "no" : "a", config.pan_tilt_uri.empty() ? "no" : "a");
  return with_end({{"cameras", config.cameras.size()},
                   {"depth", config.depth.has_value()},
                   {"depth_cameras", depth},
                   {"trigger", config.trigger_uri},
                   {"pan_tilt", config.pan_tilt_uri}},
                  arguments.out, "mixrig diag --rig " + arguments.out);
}

}  // namespace

void add_rig_command(Command app, Context& context) {
  auto arguments = std::make_shared<RigFileArguments>();
  Command rig = app.add_subcommand("rig", "describe the devices of a rig");
  rig.require_subcommand();
  Command command = rig.add_subcommand("init", "write a rig.toml of what is plugged in");
  command.add_option("OUT", arguments->out, "file to write").show_default();
  command.add_flag("--force", arguments->force, "replace the file");
  command.add_flag("--no-network", arguments->no_network, "do not look for cameras on the network");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return init(*arguments); }; });
}

}  // namespace mixrig::tools
