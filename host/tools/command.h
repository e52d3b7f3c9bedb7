// SPDX-License-Identifier: Apache-2.0
// What every subcommand of `mixrig` shares: one file per subcommand, one add_*_command each.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "hal/base/result.h"

namespace mixrig::tools {

/// Filled while the command line is parsed. The chosen subcommand sets `action`; main runs it,
/// prints its error as one line (exit status 2 for kUsage, kFormat and kNotFound of user files,
/// else 1) and writes the report that it returns where --json FILE was given.
struct Context {
  bool verbose = false;
  std::string json_path;
  std::function<Result<nlohmann::json>()> action;
};

void add_run_command(CLI::App& app, Context& context);
void add_explain_command(CLI::App& app, Context& context);
void add_info_command(CLI::App& app, Context& context);
void add_scan_command(CLI::App& app, Context& context);
void add_bench_command(CLI::App& app, Context& context);
void add_bench_estimation_command(CLI::App& app, Context& context);
void add_studio_command(CLI::App& app, Context& context);
void add_trigger_command(CLI::App& app, Context& context);
void add_flash_command(CLI::App& app, Context& context);
void add_record_command(CLI::App& app, Context& context);
void add_diag_command(CLI::App& app, Context& context);
void add_rig_command(CLI::App& app, Context& context);
void add_align_command(CLI::App& app, Context& context);
void add_calibrate_external_command(CLI::App& app, Context& context);
void add_track_command(CLI::App& app, Context& context);
void add_calibrate_intrinsics_command(CLI::App& app, Context& context);
void add_calibrate_rig_command(CLI::App& app, Context& context);
void add_calibrate_ptu_command(CLI::App& app, Context& context);

/// A progress bar on stderr, shown only when stderr is a terminal.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();  ///< clears the bar
  void step(int done);

 private:
  std::string what_;
  int total_;
  bool shown_;
};

}  // namespace mixrig::tools
