// SPDX-License-Identifier: Apache-2.0
// mixrig diag: health of every device, with advice.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/capture/capture/calibrated_source.h"
#include "host/capture/live/check/diagnose.h"
#include "host/capture/live/rig/discover.h"
#include "host/capture/open/open_source.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/rig/registration_figures.h"

namespace mixrig::tools {
namespace {

constexpr const char* kMiddle = "middle";

struct DiagArguments {
  std::string rig, grey_card;
  double watch_s = 5;
  bool no_move = false, no_network = false;
};

void print(const std::vector<live::Check>& checks) {
  std::printf("%-6s %-12s %-14s %s\n", "", "device", "check", "measured");
  for (const live::Check& check : checks) {
    std::printf("%-6s %-12s %-14s %s\n", std::string(name(check.verdict)).c_str(),
                check.device.c_str(), check.what.c_str(), check.value.c_str());
    if (!check.advice.empty()) std::printf("%-6s -> %s\n", "", check.advice.c_str());
  }
}

nlohmann::json to_json(const std::vector<live::Check>& checks) {
  nlohmann::json rows = nlohmann::json::array();
  for (const live::Check& check : checks)
    rows.push_back({{"device", check.device},
                    {"check", check.what},
                    {"verdict", std::string(name(check.verdict))},
                    {"value", check.value},
                    {"advice", check.advice}});
  return {{"verdict", std::string(name(live::worst(checks)))}, {"checks", rows}};
}

/// "X,Y,W,H" in pixels; absent for "middle". Errors: kUsage.
Result<std::optional<capture::CardArea>> parse_card(const std::string& text) {
  if (text == kMiddle) return std::optional<capture::CardArea>();
  constexpr int kMost_px = 16384;
  capture::CardArea area;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%5d,%5d,%5d,%5d%c", &area.x, &area.y,
                               &area.size.width, &area.size.height, &rest);
  if (read != 4 || area.x < 0 || area.y < 0 || area.size.empty() ||
      std::max({area.x, area.y, area.size.width, area.size.height}) > kMost_px)
    return Error{ErrorCode::kUsage,
                 "--grey-card " + text +
                     ": give X,Y,W,H in pixels of the target camera's picture, as 600,400,200,150, "
                     "or nothing for its middle fifth"};
  return std::optional(area);
}

/// Errors: kDevice, naming the checks that failed.
Result<void> verdict_of(const std::vector<live::Check>& checks) {
  std::string failed;
  for (const live::Check& check : checks)
    if (check.verdict == live::Verdict::kFail)
      failed += (failed.empty() ? "" : ", ") + check.device + " " + check.what;
  if (failed.empty()) return {};
  return Error{ErrorCode::kDevice, "diag: failed: " + failed + ": do what the table advises"};
}

/// How well depth lies on the plate in captures of the rig.
Result<measure::Registration> measured_registration(const std::string& rig, Clock& clock) {
  constexpr int kCaptures = 20;
  const std::atomic<bool> stop = false;
  MIXRIG_ASSIGN(auto source, session::open_rig(rig, scene::Scene{}, stop, clock, source_kinds()));
  MIXRIG_ASSIGN(source, capture::with_calibration(std::move(source), source->info().calibration));
  std::vector<int> numbers(kCaptures);
  std::iota(numbers.begin(), numbers.end(), 1);
  return registration_of(*source, numbers);
}

/// The check of a rig that has a calibration and whose devices have passed; absent otherwise.
std::optional<live::Check> check_registration(const std::string& rig, const live::RigConfig& config,
                                              const std::vector<live::Check>& checks,
                                              Clock& clock) {
  constexpr double kFar = 0.01;  // of the width; edges of a person who moves scatter by half of it
  const bool calibrated = !config.calibration.empty() || (config.target && config.tof);
  if (!calibrated || config.cameras.empty() || !config.depth || !verdict_of(checks))
    return std::nullopt;
  live::Check check{config.depth->name, "registration", live::Verdict::kPass, "", ""};
  const auto found = measured_registration(rig, clock);
  if (!found) {
    check.verdict = live::Verdict::kWarn, check.value = "not measured: " + found.error().context;
    check.advice = "mixrig run with this rig says what is wrong";
    return check;
  }
  check.value = registration_text(*found);
  if (!found->known() || found->median_px <= kFar * found->width_px) return check;
  check.verdict = live::Verdict::kWarn;
  check.advice = "depth lies beside what it belongs to: calibrate the rig again";
  return check;
}

Result<nlohmann::json> diag(const DiagArguments& arguments, Result<void>& found) {
  live::DiagnoseOptions options;
  options.grey_card = !arguments.grey_card.empty();
  if (options.grey_card) {
    MIXRIG_ASSIGN(options.card_area, parse_card(arguments.grey_card));
  }
  SystemClock clock;
  live::RigConfig config;
  if (arguments.rig.empty()) {
    config = live::discover({.network = !arguments.no_network}, source_kinds().devices, clock);
  } else {
    MIXRIG_ASSIGN(config, live::read_rig(arguments.rig));
  }
  options.watch = Duration(static_cast<long>(arguments.watch_s * 1e9));
  options.move_head = !arguments.no_move;
  auto checks =
      live::diagnose(config, session::device_opener(config, source_kinds(), clock), options, clock);
  if (!arguments.rig.empty())
    if (auto check = check_registration(arguments.rig, config, checks, clock))
      checks.push_back(*std::move(check));
  print(checks);
  found = verdict_of(checks);
  return to_json(checks);
}

}  // namespace

void add_diag_command(Command app, Context& context) {
  auto arguments = std::make_shared<DiagArguments>();
  Command command = app.add_subcommand(
      "diag", "open every device, watch it, and judge its health (exit status 1: a check failed)");
  command.add_option("--rig", arguments->rig, "rig.toml; if not given, the connected devices");
  command.add_option("--watch", arguments->watch_s, "seconds").show_default().range(0.5, 3600.0);
  command.add_flag("--no-move", arguments->no_move, "do not move the pan-tilt head");
  command.add_flag("--no-network", arguments->no_network, "do not search the network for cameras");
  command
      .add_option("--grey-card", arguments->grey_card,
                  "X,Y,W,H: the target camera sees a grey card there (none: in its middle fifth); "
                  "its transfer, black level and white balance are judged")
      .value_if_left_out(kMiddle);
  command.callback([&context, arguments] {
    context.action = [&context, arguments] { return diag(*arguments, context.found); };
  });
}

}  // namespace mixrig::tools
