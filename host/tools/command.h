// SPDX-License-Identifier: Apache-2.0
// Shared by all subcommands of `mixrig`: one file and one add_*_command per subcommand.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/result.h"
#include "host/tools/command_line.h"

namespace mixrig::tools {

/// State filled while the command line is parsed. The chosen subcommand sets `action`; main runs
/// it, prints its error as one line (exit status 2 for kUsage, kFormat and kNotFound of user files,
/// else 1) and, where --json FILE was given, writes the report that it returns. An action that has
/// a report although what it examined is bad sets `found`, which main prints after the report.
struct Context {
  bool verbose = false;
  std::string json_path;
  std::function<Result<nlohmann::json>()> action;
  Result<void> found;
};

/// Adds to a report what main's last line says: the file or folder `out` that was written, and
/// `next`, the command that is worth running next; either may be empty.
nlohmann::json with_end(nlohmann::json report, const std::string& out, const std::string& next);

/// What is worth doing after a calibration was written into `file`.
std::string in_rig_toml(const std::string& file);
/// What is worth doing after poses were written into `file`; empty where that is.
std::string as_trajectory(const std::string& file);

/// Adds every subcommand of this build and of its extras (commands.cpp).
void add_commands(Command app, Context& context);

/// Adds the hidden `mixrig help-pages DIR`: man pages, shell completions and
/// docs/reference/commands.md.
void add_help_pages_command(Command app, Context& context);
void add_new_command(Command app, Context& context);
void add_run_command(Command app, Context& context);
void add_explain_command(Command app, Context& context);
void add_import_command(Command app, Context& context);
void add_info_command(Command app, Context& context);
void add_scan_command(Command app, Context& context);
void add_bench_command(Command app, Context& context);
void add_learn_command(Command app, Context& context);
void add_studio_command(Command app, Context& context);
void add_trigger_command(Command app, Context& context);
void add_flash_command(Command app, Context& context);
void add_record_command(Command app, Context& context);
void add_diag_command(Command app, Context& context);
void add_rig_command(Command app, Context& context);
void add_align_command(Command app, Context& context);
void add_calibrate_external_command(Command app, Context& context);
void add_calibrate_vignetting_command(Command app, Context& context);
void add_track_command(Command app, Context& context);
void add_lights_command(Command app, Context& context);
void add_plan_command(Command app, Context& context);
void add_place_command(Command app, Context& context);
void add_calibrate_intrinsics_command(Command app, Context& context);
void add_calibrate_lens_command(Command app, Context& context);
void add_calibrate_rig_command(Command app, Context& context);
void add_calibrate_views_command(Command app, Context& context);
void add_calibrate_ptu_command(Command app, Context& context);

/// A progress bar with rate and time left on stderr, where that is a terminal. Elsewhere it writes
/// plain lines: the first half a second after the first bar began, then one in ten seconds.
class Progress {
 public:
  /// `waits_for_step`: no line before the first step.
  Progress(std::string what, int total, bool waits_for_step = false);
  ~Progress();  ///< clears the bar
  /// Sets the steps done. `seconds_left` above 0 is shown in place of that of the rate.
  void step(int done, double seconds_left = 0);

 private:
  std::string what_;
  int total_;
  bool shown_;
  std::chrono::steady_clock::time_point start_;
  std::jthread first_line_;
};

}  // namespace mixrig::tools
