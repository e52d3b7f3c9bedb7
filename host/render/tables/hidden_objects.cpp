// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/hidden_objects.h"

#include <algorithm>

namespace mixrig::render {
namespace {

std::vector<std::size_t> objects_in_set(const CompositorSetup& setup) {
  std::vector<std::size_t> in_set;
  for (std::size_t i = 0; i < setup.objects.size(); ++i)
    if (setup.objects[i].in_set) in_set.push_back(i);
  return in_set;
}

CompositorSetup without_hidden(CompositorSetup setup) {
  std::erase_if(setup.objects, [](const VirtualObject& object) { return !object.in_set; });
  return setup;
}

/// Copies ambient light, exposure and intensities; returns whether anything changed. Lamps keep
/// their places.
bool copy_light(const geometry::Light& from, geometry::Light& to) {
  bool changed = to.ambient != from.ambient || to.exposure != from.exposure;
  to.ambient = from.ambient, to.exposure = from.exposure;
  for (std::size_t i = 0; i < to.lamps.size(); ++i) {
    if (to.lamps[i].intensity == from.lamps[i].intensity) continue;
    to.lamps[i].intensity = from.lamps[i].intensity, changed = true;
  }
  return changed;
}

}  // namespace

bool any_object_hides(const CompositorSetup& setup) {
  return std::any_of(setup.objects.begin(), setup.objects.end(),
                     [](const VirtualObject& object) { return !object.in_set; });
}

HiddenObjects::HiddenObjects(const CompositorSetup& setup)
    : kept_(objects_in_set(setup)), setup_(without_hidden(setup)), preparer_(setup_) {}

void HiddenObjects::follow(const CompositorSetup& setup) {
  SetupChanges changes;
  changes.view = !(setup_.view == setup.view);
  setup_.view = setup.view;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const geometry::Pose& pose = setup.objects[kept_[k]].world_from_object;
    if (setup_.objects[k].world_from_object == pose) continue;
    setup_.objects[k].world_from_object = pose, changes.objects = true;
  }
  changes.light = copy_light(setup.light, setup_.light);
  preparer_.note(changes);
}

FramesOfSetup::FramesOfSetup(const CompositorSetup& setup) : setup_(setup), preparer_(setup) {
  if (setup.may_hide_objects && any_object_hides(setup)) hidden_.emplace(setup);
}

const FramePreparer& FramesOfSetup::update(const geometry::Pose& world_from_camera,
                                           const SetupChanges& changes, bool hides) {
  preparer_.note(changes);
  if (hidden_) hidden_->follow(setup_);
  hides_ = hides && hidden_;
  if (hides_) {
    hidden_->update(world_from_camera);
    return hidden_->preparer();
  }
  preparer_.update(world_from_camera);
  return preparer_;
}

}  // namespace mixrig::render
