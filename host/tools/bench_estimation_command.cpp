// SPDX-License-Identifier: Apache-2.0
// mixrig bench estimation: every estimator through its degeneracies, as tables, JSON and plots.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "host/app/output_folder.h"
#include "host/estimation_bench/suite.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string out = "out/bench/estimation";
  estimation_bench::Effort effort;
};

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json to_json(const estimation_bench::Report& report) {
  nlohmann::json cases = nlohmann::json::array(), blobs = nlohmann::json::array();
  for (const auto& r : report.rows)
    cases.push_back({{"estimator", r.estimator},
                     {"case", r.name},
                     {"ok", r.ok},
                     {"weak", r.weak},
                     {"degenerate", r.refused},
                     {"error_over_bound", number(r.over_bound)},
                     {"nees_per_dof", number(r.nees)},
                     {"nees_95", {number(r.low), number(r.high)}},
                     {"off_reference_sigmas", number(r.off_reference)},
                     {"time_us", number(r.micros)}});
  for (const auto& b : report.blobs)
    blobs.push_back({{"radius_px", b.radius_px},
                     {"threshold", b.threshold},
                     {"bias_px", number(b.bias_px)},
                     {"scatter_over_sigma", number(b.over_sigma)}});
  return {{"cases", cases}, {"marker_blobs", blobs}, {"faults", report.faults}};
}

Result<nlohmann::json> bench(const Words& words) {
  namespace fs = std::filesystem;
  std::error_code code;
  fs::create_directories(words.out, code);
  if (code) return Error{ErrorCode::kIo, words.out + ": the folder cannot be made", code.value()};
  const int total = static_cast<int>(estimation_bench::all_cases().size());
  Progress bar("cases", total);
  const auto report =
      estimation_bench::run_suite(words.effort, [&](int done, int) { bar.step(done); });
  const fs::path folder = words.out;
  const nlohmann::json json = to_json(report);
  const std::string table = estimation_bench::to_table(report);
  MIXRIG_TRY(app::write_text(folder / "estimation.txt", table));
  MIXRIG_TRY(app::write_text(folder / "estimation.md", estimation_bench::to_summary(report)));
  MIXRIG_TRY(app::write_text(folder / "estimation.json", json.dump(2) + "\n"));
  MIXRIG_TRY(app::write_text(folder / "estimation_cases.svg", estimation_bench::cases_svg(report)));
  MIXRIG_TRY(
      app::write_text(folder / "estimation_sweeps.svg", estimation_bench::sweeps_svg(report)));
  std::fputs(table.c_str(), stdout);
  if (!report.faults.empty())
    return Error{ErrorCode::kData,
                 std::to_string(report.faults.size()) + " measures fall short, the first is: " +
                     report.faults.front() + ": see " + (folder / "estimation.txt").string()};
  return json;
}

}  // namespace

void add_bench_estimation_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App& group = command_group(app, "bench", "measure speed against error");
  CLI::App* command = group.add_subcommand(
      "estimation", "every estimator against the Cramer-Rao bound, through its degeneracies");
  command->add_option("--out", words->out, "folder for table, JSON and plots")
      ->capture_default_str();
  command->add_option("--trials", words->effort.trials, "runs of each case")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  command->callback([&context, words] { context.action = [words] { return bench(*words); }; });
}

}  // namespace mixrig::tools
