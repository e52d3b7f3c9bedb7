// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/visitors.h"

#include <algorithm>
#include <utility>

namespace mixrig::page {

/// Guests, or those with a permitted request, of one address or of all.
std::size_t Visitors::count(bool guests, const std::string* address) const {
  return static_cast<std::size_t>(std::count_if(all_.begin(), all_.end(), [&](const Entry& one) {
    const bool of_kind = guests ? one.state == State::kGuest
                                : one.state == State::kIdle || one.state == State::kBusy;
    return of_kind && (address == nullptr || one.address == *address);
  }));
}

/// Ends the oldest connection in this state of the address or, without one, of the address that has
/// most of this kind.
bool Visitors::end_oldest(State state, const std::string* address) {
  auto victim = all_.end();
  const std::string* counted = nullptr;  // neighbours are often of one address
  std::size_t most = 0, of_address = 0;
  for (auto one = all_.begin(); one != all_.end(); ++one) {
    if (one->state != state || (address != nullptr && one->address != *address)) continue;
    if (counted == nullptr || *counted != one->address)
      counted = &one->address, of_address = count(state == State::kGuest, counted);
    if (of_address <= most) continue;
    victim = one, most = of_address;
  }
  if (victim == all_.end()) return false;
  victim->state = State::kEnding;
  victim->end();
  return true;
}

void Visitors::end_late(HostTime now) {
  for (Entry& one : all_) {
    if (one.state != State::kGuest || now < one.came + kMostFirstHeader) continue;
    one.state = State::kEnding;
    one.end();
  }
}

void Visitors::end_all() {
  for (Entry& one : all_) {
    if (one.state == State::kEnding) continue;
    one.state = State::kEnding;
    one.end();
  }
}

Visitors::Place::Place(Visitors& visitors, std::string address, HostTime came,
                       std::function<void()> end)
    : visitors_(&visitors) {
  if (visitors.count(true) >= kMostGuests) visitors.end_oldest(State::kGuest);
  at_ = visitors.all_.insert(visitors.all_.end(),
                             {std::move(address), State::kGuest, came, std::move(end)});
}

Visitors::Place::~Place() {
  if (visitors_ != nullptr) visitors_->all_.erase(at_);
}

bool Visitors::Place::admit() {
  if (at_->state == State::kGuest) {
    const std::string& address = at_->address;
    if (visitors_->count(false, &address) >= kMostOfAddress &&
        !visitors_->end_oldest(State::kIdle, &address))
      return false;
    if (visitors_->count(false) >= kMost && !visitors_->end_oldest(State::kIdle)) return false;
  }
  if (at_->state != State::kEnding) at_->state = State::kBusy;
  return true;
}

void Visitors::Place::wait() {
  if (at_->state != State::kBusy) return;
  at_->state = State::kIdle;
  visitors_->all_.splice(visitors_->all_.end(), visitors_->all_, at_);
}

void Visitors::Place::stay() {
  if (at_->state != State::kEnding) at_->state = State::kBusy;
}

}  // namespace mixrig::page
