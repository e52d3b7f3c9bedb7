// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/place_sink.h"

#include <utility>

#include "hal/base/log.h"

namespace mixrig::session {

PlaceSink::PlaceSink(const Session& session, std::shared_ptr<SceneFollower> follower,
                     output::RunControls& controls)
    : controls_(controls), desk_(session, std::move(follower)) {
  controls_.objects = static_cast<int>(session.scene.objects.size());
}

render::OutputMask PlaceSink::wanted(int /*number*/) const {
  return controls_.place_at >= 0 ? render::kMatte : 0;
}

Result<void> PlaceSink::place(const output::Composite& composite, int px) {
  const SeenFrom from{composite.world_from_target, composite.view};
  const auto objects = desk_.objects(nullptr);
  const auto index = static_cast<std::size_t>(controls_.place_object);
  controls_.objects = static_cast<int>(objects.size());
  if (index >= objects.size())
    return Error{ErrorCode::kNotFound, "the scene has no such object any more"};
  const Size size = from.view.size_px;
  const Eigen::Vector2d at((px % 65536 + 0.5) / size.width, (px / 65536 + 0.5) / size.height);
  return desk_.apply(page::SetObject{.name = objects[index].name, .onto = at}, &from);
}

Result<void> PlaceSink::write(const output::CompositePtr& composite) {
  const int px = controls_.place_at.exchange(-1);
  if (px < 0) return {};
  const auto placed = place(*composite, px);
  if (!placed) log_warning("place", to_line(placed.error()));
  controls_.place_said = placed ? "placed"
                         : placed.error().code == ErrorCode::kData
                             ? "nothing can stand there: the log says why"
                             : "not placed: the log says why";
  return {};
}

}  // namespace mixrig::session
