// SPDX-License-Identifier: Apache-2.0
// mixrig studio: renders a take with truth in the virtual studio.
#include <cstdio>
#include <memory>

#include "host/app/board_set.h"
#include "host/app/studio_take.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string out, scenario = "walk", rig = "kinect2", size = "1280x1024", format = "png";
  std::string board = "checkerboard", squares = "10x7";
  int seed = 1, frames = 60, threads = 0, views = 20;
  bool raw_depth = false, pan_tilt = false;
  double square_mm = 70, marker_mm = 0, bend_mm = 0, blur_px = 0.6, noise = 1;
  double depth_error_mm = 15, amplitude_error_mm = 0, pixel_error_mm = 0;
};

constexpr const char* kBoardScenario = "board";

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

Result<studio::BoardOptions> board_options_of(const Words& words) {
  studio::BoardOptions options;
  MIXRIG_ASSIGN(options.rig, studio::parse_rig(words.rig));
  MIXRIG_ASSIGN(options.size_px, parse_size(words.size, "--size"));
  MIXRIG_ASSIGN(options.board.kind, studio::parse_board(words.board));
  MIXRIG_ASSIGN(const Size squares, parse_size(words.squares, "--squares"));
  if (words.seed < 0) return Error{ErrorCode::kUsage, "--seed must not be negative"};
  options.seed = static_cast<unsigned>(words.seed);
  options.views = words.views;
  options.threads = words.threads;
  options.pan_tilt = words.pan_tilt;
  options.board.columns = squares.width, options.board.rows = squares.height;
  options.board.square_m = words.square_mm / 1000;
  options.board.marker_m = (words.marker_mm > 0 ? words.marker_mm : 0.75 * words.square_mm) / 1000;
  options.board.bend_m = words.bend_mm / 1000;
  options.blur_px = words.blur_px;
  options.noise = words.noise;
  options.depth_error_m = words.depth_error_mm / 1000;
  options.amplitude_error_m = words.amplitude_error_mm / 1000;
  options.pixel_error_m = words.pixel_error_mm / 1000;
  return options;
}

Result<nlohmann::json> render_board(const Words& words) {
  MIXRIG_ASSIGN(const studio::BoardOptions options, board_options_of(words));
  Progress bar("studio", options.views);
  MIXRIG_ASSIGN(const studio::BoardInfo info,
                app::write_board_set(options, words.out, [&](int n) { bar.step(n); }));
  std::printf("%s: %s, %d views of a %s\n", words.out.c_str(), info.name.c_str(), options.views,
              std::string(studio::name(options.board.kind)).c_str());
  return nlohmann::json{{"out", words.out}, {"name", info.name}, {"views", options.views}};
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

void add_board_options(CLI::App& command, Words& words) {
  const char* group = "Scenario board";
  const auto option = [&](const char* name, auto& value, const char* what) {
    command.add_option(name, value, what)->group(group)->capture_default_str();
  };
  option("--views", words.views, "How often the board is held up; every fifth far off the axis");
  option("--board", words.board, "checkerboard charuco");
  option("--squares", words.squares, "Columns x rows of squares");
  option("--square", words.square_mm, "Side of a square, mm");
  option("--marker", words.marker_mm, "ChArUco: side of a marker, mm; 0: 3/4 of a square");
  option("--bend", words.bend_mm, "The board's middle stands out by this much, mm");
  option("--blur", words.blur_px, "Sigma of every lens, px");
  option("--noise", words.noise, "Of every sensor, against its own");
  option("--depth-error", words.depth_error_mm, "Largest systematic depth error, mm");
  option("--amplitude-error", words.amplitude_error_mm, "Depth error where light is weak, mm");
  option("--pixel-error", words.pixel_error_mm, "Depth error in the corners, mm");
  command.add_flag("--ptu", words.pan_tilt, "The board stands still, the pan-tilt unit turns")
      ->group(group);
}

}  // namespace

void add_studio_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command =
      app.add_subcommand("studio", "Render a take with ground truth in the virtual studio");
  command->add_option("OUT", words->out, "Folder of the take")->required();
  command->add_option("--scenario", words->scenario,
                      "still walk talk pan handheld pendulum edges far dark board");
  command->add_option("--rig", words->rig, "sr3000 kinect2 helios2");
  command->add_option("--seed", words->seed, "Person, clothes, path and noise");
  command->add_option("--frames", words->frames, "Length; the first 25 (at most half) are empty");
  command->add_option("--size", words->size, "Target camera, WxH");
  command->add_option("--format", words->format, "png or mkv");
  command->add_option("--threads", words->threads, "0: one per core");
  command->add_flag("--raw-depth", words->raw_depth, "Leave the systematic depth error in");
  add_board_options(*command, *words);
  command->callback([words, &context] {
    context.action = [words] {
      return words->scenario == kBoardScenario ? render_board(*words) : render(*words);
    };
  });
}

}  // namespace mixrig::tools
