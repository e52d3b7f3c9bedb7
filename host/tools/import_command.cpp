// SPDX-License-Identifier: Apache-2.0
// mixrig import: makes a take of a recording that another program has made.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/output_folder.h"
#include "host/capture/take/foreign/import.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

struct ImportArguments {
  std::string source, out;
  bool force = false;
};

Result<nlohmann::json> import(const ImportArguments& arguments) {
  MIXRIG_TRY(
      check_output_folder(arguments.out, "take.toml", arguments.force ? Force::kYes : Force::kNo));
  const Progress progress("reading the recording", 1);
  MIXRIG_ASSIGN(const take::Imported made, take::import_recording(arguments.source, arguments.out));
  std::printf("%s: %d colour and %d depth pictures, %d frames\n", made.kind.c_str(), made.color,
              made.depth, made.frames);
  for (const std::string& line : made.assumed) std::printf("  assumed: %s\n", line.c_str());
  for (const std::string& line : made.lost) std::printf("  left out: %s\n", line.c_str());
  return with_end({{"kind", made.kind},
                   {"color", made.color},
                   {"depth", made.depth},
                   {"frames", made.frames},
                   {"assumed", made.assumed},
                   {"left_out", made.lost}},
                  arguments.out, "mixrig info " + arguments.out);
}

}  // namespace

void add_import_command(Command app, Context& context) {
  auto arguments = std::make_shared<ImportArguments>();
  Command command = app.add_subcommand(
      "import", "make a take of a recording of another program; pictures are kept as they are");
  command
      .add_option("SOURCE", arguments->source,
                  "file or folder: Azure Kinect or Orbbec .mkv, ROS 1 .bag, TUM, Bonn, ETH3D, "
                  "7-Scenes, ScanNet")
      .required();
  command.add_option("OUT", arguments->out, "folder of the take").required();
  command.add_flag("--force", arguments->force, "replace a take that OUT holds");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return import(*arguments); }; });
}

}  // namespace mixrig::tools
