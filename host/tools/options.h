// SPDX-License-Identifier: Apache-2.0
// Option values that several subcommands share.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/run/session/session.h"
#include "host/tools/command_line.h"

namespace mixrig::tools {

/// Parses "A-B" or "A", 1-based, A <= B. Errors: kUsage, naming the option.
Result<FrameRange> parse_range(const std::string& text, const std::string& option);
/// Parses "WxH", 1..16384 a side. Errors: kUsage.
Result<Size> parse_size(const std::string& text, const std::string& option);

/// Arguments of the command line: SCENE, --source, --calibration, --backend, --threads, --size.
struct SessionArguments {
  std::string scene, source, calibration, backend = "auto", size;
  int threads = 0;
};
void add_session_options(Command command, SessionArguments& arguments);
/// Adds --take: a folder, its take.toml, or take:DIR as --source has it.
Option add_take_option(Command command, std::string& take, const std::string& about);
void add_calibration_option(Command command, SessionArguments& arguments);
void add_backend_options(Command command, SessionArguments& arguments);
/// Size of --size; nullopt if it was not given. Errors: kUsage.
Result<std::optional<Size>> view_size(const SessionArguments& arguments);
session::BackendChoice backend_choice(const SessionArguments& arguments);
/// Session options from all arguments; the source is the take beside the scene if none was given.
/// Errors: kUsage.
Result<session::SessionOptions> session_options(const SessionArguments& arguments);

/// Opens the session of a run, and says so on stderr where that takes long. Errors: those of
/// session::open_session().
Result<std::unique_ptr<session::Session>> opened_session(const session::SessionOptions& options);

/// Prints what a scene lacks, and that a run keyed nobody, one line each, and adds them to the
/// report as "notes".
void print_notes(const scene::Scene& scene, nlohmann::json& report);

/// Makes a function that shows a progress bar on stderr for each step in turn (Progress). Unless
/// `waits`, the time until the first call has one too, for a first step that takes long.
ProgressFn progress_bar(bool waits = false);

}  // namespace mixrig::tools
