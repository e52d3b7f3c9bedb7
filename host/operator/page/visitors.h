// SPDX-License-Identifier: Apache-2.0
// Which connections the page keeps when many come. Private to this module.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <string>

#include "hal/base/clock.h"

namespace mixrig::page {

/// Connections of the page, by address, those without a permitted request yet (guests) apart from
/// the others. Guests never take the place of others. For the server's thread.
class Visitors {
  enum class State { kGuest, kIdle, kBusy, kEnding };
  struct Entry {
    std::string address;
    State state = State::kGuest;
    HostTime came{};
    std::function<void()> end;
  };
  using At = std::list<Entry>::iterator;

 public:
  static constexpr std::size_t kMostGuests = 32, kMost = 32, kMostOfAddress = 16;
  static constexpr Duration kMostFirstHeader = std::chrono::seconds(5);

  /// The place of one connection; leaves it when destroyed.
  class Place {
   public:
    Place() = default;
    /// Comes as a guest at `came`; `end`, which must not destroy the place before it returns,
    /// closes the connection when its place is needed: that of the oldest guest of the address that
    /// has most of them.
    Place(Visitors& visitors, std::string address, HostTime came, std::function<void()> end);
    ~Place();
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    /// At a permitted request: ends the oldest idle connection where all places are taken, of the
    /// same address first. Returns false where none is idle.
    bool admit();
    /// The connection waits for its next request: others may take its place.
    void wait();
    /// Takes a place for what a permitted request became: it is never idle.
    void stay();

   private:
    Visitors* visitors_ = nullptr;
    At at_{};
  };

  /// Ends the guests that came kMostFirstHeader before `now`, however much they have sent.
  void end_late(HostTime now);
  /// Ends all connections.
  void end_all();

 private:
  std::size_t count(bool guests, const std::string* address = nullptr) const;
  bool end_oldest(State state, const std::string* address = nullptr);

  std::list<Entry> all_;  ///< in the order in which they came or became idle
};

}  // namespace mixrig::page
