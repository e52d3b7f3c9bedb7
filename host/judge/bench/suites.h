// SPDX-License-Identifier: Apache-2.0
// The suites of mixrig bench that judge one stage each.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "host/judge/bench/suite.h"
#include "host/run/session/session.h"

namespace mixrig::bench {

inline constexpr std::array<std::string_view, 7> kSuites{"warp",   "refine", "key",   "mix",
                                                         "shadow", "frame",  "memory"};
bool is_suite(std::string_view name);

struct SuiteOptions {
  std::filesystem::path take;  ///< take of the studio with its scene.toml
  bool grid = false;           ///< runs peers at every setting of their grids
  bool quick = false;          ///< fewer frames, no gles
};

/// Runs one of kSuites: all levels, the peers of this build, and gles where it starts, in turn on
/// the same frames. Errors: those of the take and of a back end other than gles.
Result<Suite> run_suite(const std::string& name, const SuiteOptions& options,
                        const ProgressFn& progress);

}  // namespace mixrig::bench
