// SPDX-License-Identifier: Apache-2.0
// The `mixrig` command: parses arguments, runs the subcommand, prints its error as one line.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <malloc.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "hal/base/log.h"
#include "hal/base/output_folder.h"
#include "hal/base/partial_path.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/tools/command.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

constexpr int kDone = 0, kFailed = 1, kWrongUsage = 2;
constexpr const char* kStdout = "-";
constexpr const char *kOutKey = "out", *kNextKey = "next";

/// Adds -v and --json to every subcommand that does not define them itself.
void add_common_options(Command command, Context& context) {
  if (!command.has_option("-v")) command.add_flag("-v,--verbose", context.verbose, "log the steps");
  for (Command child : command.subcommands()) {
    if (!child.has_option("--json"))
      child.add_option("--json", context.json_path,
                       "FILE that the report is written to; -: stdout, and tables to stderr");
    add_common_options(child, context);
  }
}

using SteadyClock = std::chrono::steady_clock;

/// The last line of a command that wrote something or took a while. It goes to stdout, after the
/// tables.
void print_end(const nlohmann::json& report, SteadyClock::time_point start) {
  constexpr double kLong_s = 2;
  const double seconds = std::chrono::duration<double>(SteadyClock::now() - start).count();
  const auto text = [&](const char* key) {
    return report.is_object() && report.contains(key) && report[key].is_string()
               ? report[key].get<std::string>()
               : std::string();
  };
  const std::string out = text(kOutKey), next = text(kNextKey);
  if (out.empty() && next.empty() && seconds < kLong_s) return;
  std::string line = StopOnSignal::flag() ? "stopped" : "done";
  if (!out.empty()) line += StopOnSignal::flag() ? ": kept in " + out : ": wrote " + out;
  std::printf("%s, %.1f s%s%s\n", line.c_str(), seconds,
              next.empty() ? "" : "; next: ", next.c_str());
}

void print_error(std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "mixrig: %s\n", line.c_str());
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
  if (path.empty() || path == kStdout) return {};
  MIXRIG_TRY(check_output_file(path, "{", "--json"));
  std::error_code code;
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (std::filesystem::is_directory(folder, code)) return {};
  return Error{ErrorCode::kUsage,
               "--json " + path + ": there is no folder " + folder.string() + ": make it first"};
}

/// The report alone goes to stdout: what commands print there goes to stderr meanwhile.
Result<void> act_for_stdout(const Context& context) {
  const int report_fd = ::dup(STDOUT_FILENO);
  if (report_fd < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    return system_error(ErrorCode::kIo, "--json -: stdout cannot be written", errno);
  const auto start = SteadyClock::now();
  auto done = context.action();
  if (done) print_end(*done, start);
  std::fflush(stdout);
  ::dup2(report_fd, STDOUT_FILENO), ::close(report_fd);
  if (!done) return done.error();
  const std::string text = done->dump(2) + "\n";
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return context.found;
  return system_error(ErrorCode::kIo, "--json -: stdout cannot be written", errno);
}

Result<void> act(const Context& context) {
  MIXRIG_TRY(check_json_path(context.json_path));
  if (context.json_path == kStdout) return act_for_stdout(context);
  const auto start = SteadyClock::now();
  MIXRIG_ASSIGN(const nlohmann::json report, context.action());
  if (!context.json_path.empty()) MIXRIG_TRY(write_file(context.json_path, report.dump(2) + "\n"));
  print_end(report, start);
  return context.found;
}

/// Whether --json - is among the arguments, which may not be parsed.
bool wants_json(int argc, char** argv) {
  const std::vector<std::string_view> words(argv, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == "--json=-" ||
        (words[i] == "--json" && i + 1 < words.size() && words[i + 1] == kStdout))
      return true;
  return false;
}

/// Prints the error, with --json - also as {"error": LINE, "exit_status": N} on stdout. Returns the
/// exit status.
int fail(const std::string& line, int status, bool as_json) {
  print_error(line);
  if (as_json) std::puts(nlohmann::json{{"error", line}, {"exit_status", status}}.dump(2).c_str());
  return status;
}

int run(int argc, char** argv) {
  CommandLine line("Mixed-reality compositing camera: composites virtual objects into real film.",
                   "mixrig", "mixrig " MIXRIG_VERSION ", " + render::cpu_vectors());
  Context context;
  add_commands(line.root(), context);
  add_common_options(line.root(), context);
  const CommandLine::Parsed parsed = line.parse(argc, argv);
  if (parsed.done) return kDone;
  const bool as_json = wants_json(argc, argv);
  if (!parsed.error.empty()) return fail(parsed.error, kWrongUsage, as_json);
  if (context.verbose) set_log_level(LogLevel::kInfo);
  const auto done = act(context);
  if (done) return kDone;
  // A command that judged has written its report already.
  return fail(to_line(done.error()), exit_status(done.error()), as_json && context.found);
}

/// Images keep pages of their own, which go back to the system when they are freed: glibc would
/// keep those of a size that was freed once.
constexpr int kOwnPagesFromBytes = 1 << 20;

}  // namespace

nlohmann::json with_end(nlohmann::json report, const std::string& out, const std::string& next) {
  if (!out.empty()) report[kOutKey] = out;
  if (!next.empty()) report[kNextKey] = next;
  return report;
}

std::string in_rig_toml(const std::string& file) {
  return "name it in rig.toml: calibration = \"" + file + "\"";
}

std::string as_trajectory(const std::string& file) {
  if (file.empty()) return {};
  return "name it in scene.toml: [camera] pose = \"recorded\", trajectory = \"" + file + "\"";
}

}  // namespace mixrig::tools

int main(int argc, char** argv) {
  (void)::mallopt(M_MMAP_THRESHOLD, mixrig::tools::kOwnPagesFromBytes);
  try {
    return mixrig::tools::run(argc, argv);
  } catch (const std::exception& error) {
    mixrig::tools::print_error(std::string("failed unexpectedly: ") + error.what());
    return mixrig::tools::kFailed;
  }
}
