// SPDX-License-Identifier: Apache-2.0
// A quality level of the compositor: a setting of the scene, a back end, a size.
#pragma once

#include <functional>

#include "host/judge/bench/contender.h"
#include "host/render/contract/compositor.h"

namespace mixrig::bench {

/// Which images of a composite are judged.
enum class Look {
  kWarped,     ///< the warped depth, as depth
  kMixed,      ///< the mixed depth, as depth
  kComposite,  ///< all but its depth
};

struct Rung {
  std::string name;
  session::BackendChoice backend;
  /// Changes the scene's setup; empty: unchanged.
  std::function<void(render::CompositorSetup&)> change{};
  std::vector<render::Stage> stages{};  ///< stages whose time counts; empty: the whole frame
  /// Moves the camera by 1 mm before each timed frame, so that nothing is kept between frames.
  bool moves = false;
  bool timed = true;
  Look look = Look::kComposite;
  std::vector<Measure> measures{};
  bool heap = false;  ///< adds `heap_mb` to the row: memory of its compositor and images
};

/// Keeps references to session and frames. Errors: those of the back end and of the first frame.
Result<ContenderPtr> open_rung(Rung rung, const session::Session& session,
                               const std::vector<BenchFrame>& frames);

}  // namespace mixrig::bench
