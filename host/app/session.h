// SPDX-License-Identifier: Apache-2.0
// A session: a scene, the frames it is composited into, and the setup of the compositor.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/app/backend.h"
#include "host/app/source.h"
#include "host/model/static_background.h"
#include "host/render/compositor.h"
#include "host/scene/scene.h"

namespace mixrig::app {

/// Frame numbers, 1-based and inclusive.
using FrameRange = std::pair<int, int>;
/// Told after each of `total` steps of a long piece of work, which `what` names.
using ProgressFn = std::function<void(std::string_view what, int done, int total)>;

struct SessionOptions {
  std::filesystem::path scene;
  std::string source;             ///< as open_source, or "rig[:RIG.TOML]": live devices
  std::optional<Size> view_size;  ///< size to composite at; the take's view where absent
  BackendChoice backend;
  std::filesystem::path calibration{};      ///< calibration.yaml; empty: what scene or source name
  Clock* clock = nullptr;                   ///< of a rig's devices
  const std::atomic<bool>* stop = nullptr;  ///< ends a rig's frames
};

/// A scene's mesh in the back ends' types.
struct MeshArrays {
  std::vector<glm::vec3> positions_m, normals;
  std::vector<glm::vec2> uv;
};

/// Everything that holds for a run. `setup` borrows from the other members, so a session stays
/// where it is. Not thread-safe.
struct Session {
  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  scene::Scene scene;
  std::unique_ptr<FrameSource> source;
  std::optional<model::StaticBackground> background;
  std::vector<MeshArrays> meshes;
  render::CompositorSetup setup;
  BackendChoice backend;

  /// Where the target camera is at a frame: from the take, on the learned floor, or the origin.
  geometry::Pose world_from_target(const take::TakeFrame& frame) const;
  /// Frames to composite where the user names none: those after the learned ones.
  FrameRange default_frames() const;
};

/// Opens scene and source and prepares the setup, all but the background.
/// Errors: those of scene and take; kFormat where the scene learns from frames that the take lacks.
Result<std::unique_ptr<Session>> open_session(const SessionOptions& options);

/// Learns or loads the background, as the scene wants it; then the session is ready to composite.
/// Errors: kFormat where the scene asks for a floor that nothing gives; kData where the background
/// is of another view; those of reading and composing.
Result<void> prepare_background(Session& session, const ProgressFn& progress);

/// The setup that a take alone gives: cameras, noise; no objects, lamps or background.
/// Errors: kUsage for a view size that is not 1..16384.
Result<render::CompositorSetup> setup_of(const take::TakeInfo& info, std::optional<Size> view_size);

/// The same field of view on another grid of pixels.
geometry::Pinhole resized(const geometry::Pinhole& view, Size size);

/// Warps frames `range` of a source into the view of `setup` and learns the empty room from them.
/// Errors: kFormat for frames that the source lacks, those of reading, composing and learning.
Result<model::StaticBackground> learn_background(FrameSource& source,
                                                 const render::CompositorSetup& setup,
                                                 FrameRange range, BackendChoice backend,
                                                 const ProgressFn& progress);

}  // namespace mixrig::app
