// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/place_sink.h"

#include <utility>

#include "hal/base/log.h"

namespace mixrig::session {

PlaceSink::PlaceSink(const Session& session, std::shared_ptr<SceneFollower> follower,
                     output::RunOrders& orders)
    : orders_(orders), desk_(session, std::move(follower)) {
  orders_.tell([objects = static_cast<int>(session.scene.objects.size())](output::RunState& run) {
    run.objects = objects;
  });
}

render::OutputMask PlaceSink::wanted(int /*number*/) const {
  return orders_.waits<output::PlaceObject>() ? render::kMatte : 0;
}

Result<void> PlaceSink::place(const output::Composite& composite,
                              const output::PlaceObject& order) {
  const SeenFrom from{composite.world_from_target, composite.view};
  const auto objects = desk_.objects(nullptr);
  orders_.tell(
      [count = static_cast<int>(objects.size())](output::RunState& run) { run.objects = count; });
  const auto index = static_cast<std::size_t>(order.object);
  if (index >= objects.size())
    return Error{ErrorCode::kNotFound, "the scene has no such object any more"};
  const Size size = from.view.size_px;
  const Eigen::Vector2d at((order.pixel.x + 0.5) / size.width, (order.pixel.y + 0.5) / size.height);
  return desk_.apply(page::SetObject{.name = objects[index].name, .onto = at}, &from);
}

Result<void> PlaceSink::write(const output::CompositePtr& composite) {
  const auto order = orders_.take<output::PlaceObject>();
  if (!order) return {};
  const auto placed = place(*composite, *order);
  if (!placed) log_warning("place", to_line(placed.error()));
  const output::Placement told = placed ? output::Placement::kPlaced
                                 : placed.error().code == ErrorCode::kData
                                     ? output::Placement::kNoSurface
                                     : output::Placement::kFailed;
  orders_.tell([told](output::RunState& run) { ++run.placements, run.placed = told; });
  return {};
}

}  // namespace mixrig::session
