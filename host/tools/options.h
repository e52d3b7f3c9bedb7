// SPDX-License-Identifier: Apache-2.0
// Option values that several subcommands share.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/app/session.h"

namespace mixrig::tools {

/// "A-B" or "A", 1-based, A <= B. Errors: kUsage, naming the option.
Result<app::FrameRange> parse_range(const std::string& text, const std::string& option);
/// "WxH", 1..16384 a side. Errors: kUsage.
Result<Size> parse_size(const std::string& text, const std::string& option);

/// SCENE, --source, --calibration, --backend, --threads, --size as words of the command line.
struct SessionWords {
  std::string scene, source, calibration, backend = "auto", size;
  int threads = 0;
};
void add_session_options(CLI::App& command, SessionWords& words);
void add_calibration_option(CLI::App& command, SessionWords& words);
void add_backend_options(CLI::App& command, SessionWords& words);
/// The size that was named, if any. Errors: kUsage.
Result<std::optional<Size>> view_size(const SessionWords& words);
app::BackendChoice backend_choice(const SessionWords& words);
/// All of them; the source is the take beside the scene where none was named. Errors: kUsage.
Result<app::SessionOptions> session_options(const SessionWords& words);

/// The subcommand `name` of several files: made by whoever comes first, with the same `about`.
CLI::App& command_group(CLI::App& app, const std::string& name, const std::string& about);

/// A bar on stderr for each piece of work in turn (Progress).
app::ProgressFn progress_bar();

}  // namespace mixrig::tools
