// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/touch_watch.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "extras/people/touch/body_gap.h"
#include "extras/people/touch/shape_gap.h"

namespace mixrig::touch {
namespace {

bool same(const geometry::Pose& a, const geometry::Pose& b) {
  return a.translation_m == b.translation_m && a.rotation.coeffs() == b.rotation.coeffs();
}

bool is_touching(const std::optional<Gap>& gap) { return gap && gap->m < -gap->sigma_m; }

}  // namespace

TouchWatch::TouchWatch(std::vector<Shape> shapes, const ContactOptions& options,
                       std::vector<bool> gives_way)
    : shapes_(std::move(shapes)),
      options_(options),
      still_(options),
      yields_(options),
      gives_way_(std::move(gives_way)) {
  still_.frames_to_enter = 1;
  still_.leave_s = 0;
  still_.hit_m_s = std::numeric_limits<double>::infinity();
  yields_.least_m = -kYields_m, yields_.sure_sigmas = 0;
  yields_.leave_m = 2 * kYields_m;
  gives_way_.resize(shapes_.size());
}

Contact& TouchWatch::contact(Against against, int object, int other) {
  const auto at = std::find_if(contacts_.begin(), contacts_.end(), [&](const Contact& c) {
    return c.against() == against && c.object() == object && c.other() == other;
  });
  return at != contacts_.end() ? *at : contacts_.emplace_back(against, object, other);
}

std::span<const Event> TouchWatch::add(const Moment& moment) {
  events_.clear();
  if (moment.world_from_object.size() != shapes_.size()) return finish(moment.time_s);
  end_of_gone(moment);
  moved_.assign(shapes_.size(), false);
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    moved_[i] = last_.size() != shapes_.size() || !same(last_[i], moment.world_from_object[i]);
  last_.assign(moment.world_from_object.begin(), moment.world_from_object.end());
  if (!room_done_) watch_room(moment);
  watch_objects(moment);
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    if (!shapes_[i].parts.empty()) watch_people(static_cast<int>(i), moment);
  return events_;
}

void TouchWatch::watch_people(int object, const Moment& moment) {
  const auto number = static_cast<std::size_t>(object);
  const Shape& shape = shapes_[number];
  const geometry::Pose& pose = moment.world_from_object[number];
  const auto gaps = surface_.measure(shape, pose, moment);
  for (std::size_t i = 0; i < moment.people.size(); ++i) {
    const plan::Person& person = moment.people[i];
    std::optional<Gap> gap = gaps[i];
    if (!is_touching(gap) && !person.surface.empty()) {
      const auto unseen = body_gap(proxy_of(person), shape, pose, moment.seen);
      if (unseen && unseen->m < -kProxySigmas * unseen->sigma_m) gap = unseen;
    }
    const bool known = std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& c) {
      return c.against() == Against::kPerson && c.object() == object && c.other() == person.id;
    });
    if (!gap && !known) continue;
    contact(Against::kPerson, object, person.id)
        .add(gap, person.sight == plan::Sight::kHidden, moment.time_s,
             gives_way_[number] ? yields_ : options_, events_);
  }
}

void TouchWatch::watch_objects(const Moment& moment) {
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    for (std::size_t k = i + 1; k < shapes_.size(); ++k) {
      if (!moved_[i] && !moved_[k]) continue;
      contact(Against::kObject, static_cast<int>(i), static_cast<int>(k))
          .add(shape_gap(shapes_[i], moment.world_from_object[i], shapes_[k],
                         moment.world_from_object[k]),
               false, moment.time_s, still_, events_);
    }
}

void TouchWatch::watch_room(const Moment& moment) {
  room_done_ = true;
  if (room_.empty()) return;
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    if (!shapes_[i].parts.empty())
      contact(Against::kRoom, static_cast<int>(i), 0)
          .add(room_gap(shapes_[i], moment.world_from_object[i], room_), false, moment.time_s,
               still_, events_);
}

/// Ends the contacts of people whom the tracker has given up.
void TouchWatch::end_of_gone(const Moment& moment) {
  std::erase_if(contacts_, [&](Contact& c) {
    const bool gone = c.against() == Against::kPerson &&
                      std::none_of(moment.people.begin(), moment.people.end(),
                                   [&](const plan::Person& p) { return p.id == c.other(); });
    if (gone) c.end(moment.time_s, events_);
    return gone;
  });
}

std::span<const Event> TouchWatch::finish(double time_s) {
  events_.clear();
  for (Contact& c : contacts_) c.end(time_s, events_);
  contacts_.clear();
  last_.clear();
  room_done_ = false;
  return events_;
}

}  // namespace mixrig::touch
