// SPDX-License-Identifier: Apache-2.0
// A rung of the compositor: a setting of the scene, a back end, a size.
#pragma once

#include <functional>

#include "host/judge/bench/contender.h"
#include "host/render/contract/compositor.h"

namespace mixrig::bench {

/// What is looked at of a composite.
enum class Look {
  kWarped,     ///< the warped depth as depth
  kMixed,      ///< the mixed depth as depth
  kComposite,  ///< not its depth
};

struct Rung {
  std::string name;
  session::BackendChoice backend;
  std::function<void(render::CompositorSetup&)> change{};  ///< of the scene's setup; none: as it is
  std::vector<render::Stage> stages{};  ///< whose time counts; empty: that of the whole frame
  bool moves =
      false;  ///< the camera, by 1 mm before each timed frame: nothing is kept between them
  bool timed = true;
  Look look = Look::kComposite;
  std::vector<Measure> measures{};
  bool heap = false;  ///< the row has `heap_mb`, what its compositor and images hold
};

/// Borrows session and frames. Errors: those of the back end, of the first frame.
Result<ContenderPtr> open_rung(Rung rung, const session::Session& session,
                               const std::vector<BenchFrame>& frames);

}  // namespace mixrig::bench
