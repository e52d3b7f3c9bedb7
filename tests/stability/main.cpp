// SPDX-License-Identifier: Apache-2.0
// estimation_bench: runs every estimator through its degeneracies; writes tables, JSON and plots.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json to_json(const Report& report) {
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

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

/// Runs the suite and returns the number of measures that fall short.
std::size_t bench(const std::filesystem::path& folder, const Effort& effort) {
  std::filesystem::create_directories(folder);
  const auto report = run_suite(effort, [](int done, int total) {
    std::fprintf(stderr, "\rcases %d of %d%s", done, total, done == total ? "\n" : "");
  });
  const std::string table = to_table(report);
  write(folder / "estimation.txt", table);
  write(folder / "estimation.md", to_summary(report));
  write(folder / "estimation.json", to_json(report).dump(2) + "\n");
  write(folder / "estimation_sweeps.svg", sweeps_svg(report));
  std::fputs(table.c_str(), stdout);
  if (!report.faults.empty())
    std::fprintf(stderr, "estimation_bench: %zu measures fall short, the first is: %s: see %s\n",
                 report.faults.size(), report.faults.front().c_str(),
                 (folder / "estimation.txt").c_str());
  return report.faults.size();
}

}  // namespace
}  // namespace mixrig::estimation_bench

int main(int argc, char** argv) {
  std::string out = "out/bench/estimation";
  mixrig::estimation_bench::Effort effort;
  CLI::App app("Every estimator against the Cramer-Rao bound, through its degeneracies.",
               "estimation_bench");
  app.add_option("--out", out, "folder for table, JSON and plots")->capture_default_str();
  app.add_option("--trials", effort.trials, "runs of each case")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
    return mixrig::estimation_bench::bench(out, effort) == 0 ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "estimation_bench: %s\n", error.what());
    return 1;
  }
}
