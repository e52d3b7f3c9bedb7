// SPDX-License-Identifier: Apache-2.0
#include "host/tools/options.h"

#include <charconv>
#include <filesystem>
#include <memory>

#include "host/tools/command.h"
#include "host/tools/extras.h"

namespace mixrig::tools {
namespace {

/// "A<mark>B" as two whole numbers; nullopt for anything else.
std::optional<std::pair<int, int>> pair_of(const std::string& text, char mark) {
  std::pair<int, int> out;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, out.first);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != mark) return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, out.second);
  if (second.ec != std::errc{} || second.ptr != end) return std::nullopt;
  return out;
}

/// Refuses a SCENE that is no file.
Result<void> check_scene_file(const std::string& scene) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (fs::is_directory(scene, code)) {
    const fs::path inside = fs::path(scene) / "scene.toml";
    return Error{ErrorCode::kUsage,
                 "'" + scene + "' is a folder: name a scene" +
                     (fs::exists(inside, code) ? ", such as " + inside.string() : ".toml")};
  }
  if (fs::exists(scene, code)) return {};
  return Error{ErrorCode::kNotFound,
               "there is no scene '" + scene + "': name one, or make one by mixrig new FOLDER"};
}

/// The given source, a bare folder being a take; else the take in the scene's folder.
Result<std::string> source_of(const SessionArguments& arguments) {
  MIXRIG_TRY(check_scene_file(arguments.scene));
  if (!arguments.source.empty()) return arguments.source;
  const auto folder = (std::filesystem::path(".") / arguments.scene).parent_path();
  std::error_code code;
  if (std::filesystem::exists(folder / "take.toml", code)) return "take:" + folder.string();
  return Error{ErrorCode::kUsage, "no --source given and no take.toml beside " + arguments.scene +
                                      ": give the take's folder as --source"};
}

}  // namespace

Result<FrameRange> parse_range(const std::string& text, const std::string& option) {
  const bool single = text.find('-') == std::string::npos;
  const auto range = pair_of(single ? text + "-" + text : text, '-');
  if (!range || range->first < 1 || range->second < range->first)
    return Error{ErrorCode::kUsage,
                 option + " \"" + text + "\" is not a range of frames: give FIRST-LAST, from 1 on"};
  return *range;
}

Result<Size> parse_size(const std::string& text, const std::string& option) {
  const auto sides = pair_of(text, 'x');
  if (!sides || sides->first < 1 || sides->second < 1 || sides->first > 16384 ||
      sides->second > 16384)
    return Error{ErrorCode::kUsage,
                 option + " \"" + text + "\" is not a size: give WIDTHxHEIGHT, 1 to 16384 each"};
  return Size{sides->first, sides->second};
}

void add_backend_options(Command command, SessionArguments& arguments) {
  command
      .add_option("--backend", arguments.backend,
                  "auto, gles or cpu: auto uses gles on a real GPU, else cpu")
      .one_of({"auto", "gles", "cpu"});
  command
      .add_option("--threads", arguments.threads, "threads of the cpu back end, 0 = one per core")
      .range(0, 256);
}

Option add_take_option(Command command, std::string& take, const std::string& about) {
  return command.add_option("--take", take, about + ": folder or take.toml")
      .without_prefix("take:");
}

void add_calibration_option(Command command, SessionArguments& arguments) {
  command.add_option("--calibration", arguments.calibration,
                     "calibration.toml of the cameras; that of scene, take or rig if not given");
}

void add_session_options(Command command, SessionArguments& arguments) {
  command.add_option("SCENE", arguments.scene, "scene.toml: what to composite").required();
  constexpr const char* kSources =
      "take:DIR, studio[:SCENARIO,SEED,RIG] rendered on the fly, or rig[:RIG.TOML]";
  command.add_option("--source", arguments.source,
                     std::string(kSources) + "; the take beside SCENE if not given");
  command.add_option("--size", arguments.size,
                     "WxH to composite at; the take's own size if not given");
  add_calibration_option(command, arguments);
  add_backend_options(command, arguments);
}

Result<std::optional<Size>> view_size(const SessionArguments& arguments) {
  if (arguments.size.empty()) return std::optional<Size>();
  constexpr Size kMost{7680, 4320};  // some 300 bytes a pixel: 10 GB
  MIXRIG_ASSIGN(const Size size, parse_size(arguments.size, "--size"));
  if (size.area() > kMost.area())
    return Error{ErrorCode::kUsage, "--size \"" + arguments.size +
                                        "\" has more pixels than 7680x4320: the memory would not "
                                        "hold them, give a smaller one"};
  return std::optional(size);
}

session::BackendChoice backend_choice(const SessionArguments& arguments) {
  const render::Backend backend = arguments.backend == "gles"  ? render::Backend::kGles
                                  : arguments.backend == "cpu" ? render::Backend::kCpu
                                                               : render::Backend::kAuto;
  return {backend, arguments.threads};
}

Result<session::SessionOptions> session_options(const SessionArguments& arguments) {
  session::SessionOptions options;
  options.scene = arguments.scene;
  options.calibration = arguments.calibration;
  MIXRIG_ASSIGN(options.source, source_of(arguments));
  MIXRIG_ASSIGN(options.view_size, view_size(arguments));
  options.backend = backend_choice(arguments);
  options.extra_poses = extra_poses();
  options.kinds = source_kinds();
  return options;
}

Result<std::unique_ptr<session::Session>> opened_session(const session::SessionOptions& options) {
  const Progress progress("opening the scene", 1);
  return session::open_session(options);
}

void print_notes(const scene::Scene& scene, nlohmann::json& report) {
  std::vector<const char*> notes;
  const bool has_objects = !scene.objects.empty() || scene.set;
  if (!has_objects) notes.push_back("no [[object]] and no [set]: the composite is the plate");
  if (!scene.background.learn && !scene.background.model && !scene.capture_volume)
    notes.push_back("no [background] and no camera.capture_volume: nobody is keyed");
  if (!scene.objects.empty() && scene.light.lamps.empty() && !scene.light.find_lamps)
    notes.push_back("no [[light.lamp]]: objects are lit from all sides and cast no shadow");
  constexpr double kNobody_pct = 0.01;  // as the report rounds
  const bool keys = scene.background.learn || scene.background.model || scene.capture_volume;
  if (keys && report.contains("foreground_pct") && report["foreground_pct"]["max"].is_number() &&
      report["foreground_pct"]["max"].get<double>() < kNobody_pct)
    notes.push_back("nobody was keyed in any frame: nobody came, or the background has who did");
  for (const char* note : notes) std::printf("  note: %s: %s\n", scene.path.string().c_str(), note);
  if (!notes.empty()) report["notes"] = notes;
}

ProgressFn progress_bar(bool waits) {
  struct Bar {
    std::string what;
    std::optional<Progress> progress;
  };
  auto shared = std::make_shared<Bar>();
  if (!waits) shared->progress.emplace(shared->what = "first step", 1);
  return [bar = std::move(shared)](std::string_view what, int done, int total) {
    if (!bar->progress || bar->what != what) {
      bar->what = what;
      bar->progress.emplace(bar->what, total, true);
    }
    bar->progress->step(done);
    if (done >= total) bar->progress.reset();
  };
}

}  // namespace mixrig::tools
