// SPDX-License-Identifier: Apache-2.0
// The `mixrig` command: parses arguments, runs the subcommand, prints its error as one line.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "hal/base/log.h"
#include "hal/base/partial_path.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

constexpr int kDone = 0, kFailed = 1, kWrongUsage = 2;

/// Adds -v and --json to every subcommand that does not define them itself.
void add_common_options(CLI::App& command, Context& context) {
  if (command.get_option_no_throw("-v") == nullptr)
    command.add_flag("-v,--verbose", context.verbose, "log the steps");
  for (CLI::App* child : command.get_subcommands({})) {
    if (child->get_option_no_throw("--json") == nullptr)
      child->add_option("--json", context.json_path, "FILE that the report is written to");
    add_common_options(*child, context);
  }
}

void print_error(std::string line) {
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

/// Checks before the work that the report can be written.
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
  return write_file(context.json_path, report.dump(2) + "\n");
}

int run(int argc, char** argv) {
  CLI::App app("Mixed-reality compositing camera: composites virtual objects into real film.",
               "mixrig");
  Context context;
  app.require_subcommand(1);
  app.set_version_flag("--version", "mixrig " MIXRIG_VERSION ", " + render::cpu_vectors());
  add_commands(app, context);
  add_common_options(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    print_error(usage_line(app, error));
    return kWrongUsage;
  }
  if (context.verbose) set_log_level(LogLevel::kInfo);
  const auto done = act(context);
  if (done) return kDone;
  print_error(to_line(done.error()));
  return exit_status(done.error());
}

}  // namespace
}  // namespace mixrig::tools

int main(int argc, char** argv) {
  try {
    return mixrig::tools::run(argc, argv);
  } catch (const std::exception& error) {
    mixrig::tools::print_error(std::string("failed unexpectedly: ") + error.what());
    return mixrig::tools::kFailed;
  }
}
