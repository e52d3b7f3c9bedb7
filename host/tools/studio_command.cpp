// SPDX-License-Identifier: Apache-2.0
// mixrig studio: renders a take with truth in the virtual studio.
#include <cstdio>
#include <memory>

#include "host/app/studio_take.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string out, scenario = "walk", rig = "kinect2", size = "1280x1024", format = "png";
  int seed = 1, frames = 60, threads = 0;
  bool raw_depth = false;
};

Result<studio::StudioOptions> options_of(const Words& words) {
  studio::StudioOptions options;
  MIXRIG_ASSIGN(options.scenario, studio::parse_scenario(words.scenario));
  MIXRIG_ASSIGN(options.rig, studio::parse_rig(words.rig));
  MIXRIG_ASSIGN(options.size_px, parse_size(words.size, "--size"));
  if (words.seed < 0) return Error{ErrorCode::kUsage, "--seed must not be negative"};
  options.seed = static_cast<unsigned>(words.seed);
  options.frames = words.frames;
  options.threads = words.threads;
  options.raw_depth = words.raw_depth;
  return options;
}

Result<take::StreamFormat> format_of(const std::string& word) {
  if (word == "png") return take::StreamFormat::kPng;
  if (word == "mkv") return take::StreamFormat::kMatroska;
  return Error{ErrorCode::kUsage, "unknown --format \"" + word + "\": use png or mkv"};
}

Result<nlohmann::json> render(const Words& words) {
  MIXRIG_ASSIGN(const studio::StudioOptions options, options_of(words));
  MIXRIG_ASSIGN(const take::StreamFormat format, format_of(words.format));
  Progress bar("studio", options.frames);
  MIXRIG_ASSIGN(const studio::StudioInfo info,
                app::write_studio_take(options, words.out, format, [&](int n) { bar.step(n); }));
  std::printf("%s: %s, %d frames of %dx%d, the first %d empty\n", words.out.c_str(),
              info.name.c_str(), info.frames, info.target.size_px.width, info.target.size_px.height,
              info.empty_frames);
  return nlohmann::json{{"out", words.out},
                        {"name", info.name},
                        {"frames", info.frames},
                        {"empty_frames", info.empty_frames},
                        {"size", words.size}};
}

}  // namespace

void add_studio_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command =
      app.add_subcommand("studio", "Render a take with ground truth in the virtual studio");
  command->add_option("OUT", words->out, "Folder of the take")->required();
  command->add_option("--scenario", words->scenario,
                      "still walk talk pan handheld pendulum edges far dark");
  command->add_option("--rig", words->rig, "sr3000 kinect2 helios2");
  command->add_option("--seed", words->seed, "Person, clothes, path and noise");
  command->add_option("--frames", words->frames, "Length; the first 25 (at most half) are empty");
  command->add_option("--size", words->size, "Target camera, WxH");
  command->add_option("--format", words->format, "png or mkv");
  command->add_option("--threads", words->threads, "0: one per core");
  command->add_flag("--raw-depth", words->raw_depth, "Leave the systematic depth error in");
  command->callback([words, &context] { context.action = [words] { return render(*words); }; });
}

}  // namespace mixrig::tools
