// SPDX-License-Identifier: Apache-2.0
// Detects what touches virtual objects, frame by frame.
#pragma once

#include <span>
#include <vector>

#include "extras/people/plan/floor_map.h"
#include "extras/people/touch/contact.h"
#include "extras/people/touch/moment.h"
#include "extras/people/touch/shape.h"
#include "extras/people/touch/surface_gap.h"

namespace mixrig::touch {

/// Detects contacts of people with objects from their visible surface, or from a body proxy on the
/// side that no camera sees, which must be inside the object by kProxySigmas. Also detects contacts
/// between objects that have moved (without kHit, which Physics reports), and of objects with the
/// room, where they first stand. One thread. Allocates where somebody new comes near an object, and
/// for events.
class TouchWatch {
 public:
  static constexpr double kProxySigmas = 2;

  static constexpr double kYields_m = 0.03;

  /// `gives_way`: one for each shape, or empty. An object that gives way is pushed off before
  /// anything enters it, so being kYields_m near counts as touching it.
  explicit TouchWatch(std::vector<Shape> shapes, const ContactOptions& options = {},
                      std::vector<bool> gives_way = {});
  const std::vector<Shape>& shapes() const { return shapes_; }
  /// Sets the points of the empty room; before the first frame.
  void set_room(std::vector<plan::RoomPoint> room) { room_ = std::move(room); }

  /// Events of the frame, valid until the next. Precondition: as many poses as shapes, or none, in
  /// which case all contacts end; time increases.
  std::span<const Event> add(const Moment& moment);
  /// Ends all contacts.
  std::span<const Event> finish(double time_s);

 private:
  Contact& contact(Against against, int object, int other);
  void watch_people(int object, const Moment& moment);
  void watch_objects(const Moment& moment);
  void watch_room(const Moment& moment);
  void end_of_gone(const Moment& moment);

  std::vector<Shape> shapes_;
  ContactOptions options_, still_, yields_;  ///< still_: for pairs that are measured only once
  std::vector<bool> gives_way_;
  std::vector<plan::RoomPoint> room_;
  SurfaceGaps surface_;
  std::vector<Contact> contacts_;
  std::vector<geometry::Pose> last_;  ///< poses of the frame before
  std::vector<bool> moved_;
  bool room_done_ = false;
  std::vector<Event> events_;
};

}  // namespace mixrig::touch
