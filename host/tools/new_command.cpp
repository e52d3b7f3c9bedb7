// SPDX-License-Identifier: Apache-2.0
// mixrig new: a folder with a short take and a scene that explains itself.
#include <array>
#include <memory>
#include <string_view>

#include <nlohmann/json.hpp>

#include "hal/base/output_folder.h"
#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/tools/command.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"
#include "studio/io/studio_take.h"

namespace mixrig::tools {
namespace {

constexpr std::size_t kMostScene = 1 << 16;

struct Comment {
  std::string_view before, text;
};
constexpr std::array kComments{
    Comment{"[camera]",
            "# What is composited. docs/reference/scene.md lists all keys.\n"
            "# Where the camera is: \"take\" reads the poses of the take, \"floor\" finds "
            "the floor.\n"},
    Comment{"[background]", "# The frames that show the room without people, first and last.\n"},
    Comment{"[[object]]",
            "# A virtual object, glTF; metres, z is up. mixrig place sets it on a "
            "surface.\n"},
    Comment{"[light]", "# Light of the room. ambient comes from all sides.\n"},
    Comment{"[[light.lamp]]",
            "# A lamp: its shadows fall on the room. mixrig lights finds those of "
            "a room.\n"},
    Comment{"[key]", "# People are what stands at least threshold_m before the room.\n"}};

/// The scene with a comment before the first of each of its tables.
std::string commented(std::string scene) {
  for (const Comment& comment : kComments)
    if (const std::size_t at = scene.find(comment.before); at != std::string::npos)
      scene.insert(at, comment.text);
  return scene;
}

Result<nlohmann::json> make_folder(const std::string& folder, bool force) {
  MIXRIG_TRY(check_output_folder(folder, "take.toml", force ? Force::kYes : Force::kNo));
  studio::StudioOptions options;
  options.size_px = {320, 256}, options.frames = 24, options.seed = 11;
  options.realism = {};
  Progress bar("studio", options.frames);
  const StopOnSignal signals;
  MIXRIG_TRY(studio_io::write_studio_take(
      options, folder, take::StreamFormat::kPng, [&](int n) { bar.step(n); },
      &StopOnSignal::flag()));
  const std::string file = folder + "/scene.toml";
  MIXRIG_ASSIGN(const std::string scene, config::read_text(file, kMostScene));
  MIXRIG_TRY(write_file(file, commented(scene)));
  return with_end({}, folder, "mixrig run " + file + " --out FOLDER");
}

}  // namespace

void add_new_command(Command app, Context& context) {
  struct Arguments {
    std::string folder;
    bool force = false;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand(
      "new", "make a folder with a short take and a commented scene, which run composites");
  command.add_option("FOLDER", arguments->folder, "new folder").required();
  command.add_flag("--force", arguments->force, "replace a take that FOLDER holds");
  command.callback([&context, arguments] {
    context.action = [arguments] { return make_folder(arguments->folder, arguments->force); };
  });
}

}  // namespace mixrig::tools
