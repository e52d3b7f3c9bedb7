// SPDX-License-Identifier: Apache-2.0
// The `mixrig` command: parses words, runs the chosen subcommand, tells its error as one line.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "hal/base/log.h"
#include "host/app/output_folder.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

constexpr int kDone = 0, kFailed = 1, kWrongUsage = 2;

/// -v and --json stand behind every subcommand that has not made them its own.
void add_common_options(CLI::App& command, Context& context) {
  if (command.get_option_no_throw("-v") == nullptr)
    command.add_flag("-v,--verbose", context.verbose, "say what is done");
  for (CLI::App* child : command.get_subcommands({})) {
    if (child->get_option_no_throw("--json") == nullptr)
      child->add_option("--json", context.json_path, "FILE that the report is written to");
    add_common_options(*child, context);
  }
}

void add_commands(CLI::App& app, Context& context) {
  add_run_command(app, context);
  add_scan_command(app, context);
  add_explain_command(app, context);
  add_info_command(app, context);
#ifdef MIXRIG_HAS_STUDIO_COMMAND
  add_studio_command(app, context);
#endif
#ifdef MIXRIG_HAS_BENCH_COMMAND
  add_bench_command(app, context);
#endif
#ifdef MIXRIG_HAS_BENCH_ESTIMATION_COMMAND
  add_bench_estimation_command(app, context);
#endif
#ifdef MIXRIG_HAS_TRIGGER_COMMAND
  add_trigger_command(app, context);
#endif
#ifdef MIXRIG_HAS_FLASH_COMMAND
  add_flash_command(app, context);
#endif
#ifdef MIXRIG_HAS_RECORD_COMMAND
  add_record_command(app, context);
#endif
#ifdef MIXRIG_HAS_DIAG_COMMAND
  add_diag_command(app, context);
#endif
#ifdef MIXRIG_HAS_RIG_COMMAND
  add_rig_command(app, context);
#endif
#ifdef MIXRIG_HAS_ALIGN_COMMAND
  add_align_command(app, context);
#endif
#ifdef MIXRIG_HAS_CALIBRATE_EXTERNAL_COMMAND
  add_calibrate_external_command(app, context);
#endif
#ifdef MIXRIG_HAS_TRACK_COMMAND
  add_track_command(app, context);
#endif
#ifdef MIXRIG_HAS_CALIBRATE_INTRINSICS_COMMAND
  add_calibrate_intrinsics_command(app, context);
#endif
#ifdef MIXRIG_HAS_CALIBRATE_RIG_COMMAND
  add_calibrate_rig_command(app, context);
  add_calibrate_ptu_command(app, context);
#endif
  add_common_options(app, context);
}

void tell(std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "mixrig: %s\n", line.c_str());
}

std::string usage_line(const CLI::App& app, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  if (!chosen.empty())
    return chosen.front()->get_name() + ": " + error.what() + ": see mixrig " +
           chosen.front()->get_name() + " --help";
  std::string known;
  for (const CLI::App* command : app.get_subcommands({})) known += " " + command->get_name();
  const auto rest = app.remaining();
  return (rest.empty() ? std::string("no command given") : "unknown command " + rest.front()) +
         ": use one of" + known;
}

int exit_status(const Error& error) {
  switch (error.code) {
    case ErrorCode::kUsage:
    case ErrorCode::kFormat:
    case ErrorCode::kNotFound:
      return kWrongUsage;
    default:
      return kFailed;
  }
}

/// Where a report cannot be written is known before the work, not after.
Result<void> check_json_path(const std::string& path) {
  if (path.empty()) return {};
  const auto folder = std::filesystem::absolute(path).parent_path();
  std::error_code code;
  if (std::filesystem::is_directory(folder, code)) return {};
  return Error{ErrorCode::kUsage,
               "--json " + path + ": there is no folder " + folder.string() + ": make it first"};
}

Result<void> act(const Context& context) {
  MIXRIG_TRY(check_json_path(context.json_path));
  MIXRIG_ASSIGN(const nlohmann::json report, context.action());
  if (context.json_path.empty()) return {};
  return app::write_text(context.json_path, report.dump(2) + "\n");
}

int run(int argc, char** argv) {
  CLI::App app("Mixed-reality compositing camera: composites virtual objects into real film.",
               "mixrig");
  Context context;
  app.require_subcommand(1);
  app.set_version_flag("--version", "mixrig " MIXRIG_VERSION ", " + render::cpu_vectors());
  add_commands(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    tell(usage_line(app, error));
    return kWrongUsage;
  }
  if (context.verbose) set_log_level(LogLevel::kInfo);
  const auto done = act(context);
  if (done) return kDone;
  tell(to_line(done.error()));
  return exit_status(done.error());
}

}  // namespace
}  // namespace mixrig::tools

int main(int argc, char** argv) {
  try {
    return mixrig::tools::run(argc, argv);
  } catch (const std::exception& error) {
    mixrig::tools::tell(std::string("failed unexpectedly: ") + error.what());
    return mixrig::tools::kFailed;
  }
}
