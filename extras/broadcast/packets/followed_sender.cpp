// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/followed_sender.h"

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::stream {

bool FollowedSender::takes(int number, std::uint32_t sender, int port) {
  if (stated_.sender && sender != *stated_.sender) return false;
  if (stated_.number && number != *stated_.number) return false;
  if (!number_) number_ = number;
  if (number != *number_) {
    if (!number_warned_) warn_of_number(number, port);
    return false;
  }
  if (!sender_) sender_ = sender;
  if (sender == *sender_) {
    others_ = 0;
    return true;
  }
  if (!sender_warned_) warn_of_sender(sender, port);
  others_ = other_ == sender ? others_ + 1 : 1;
  other_ = sender;
  if (others_ <= kSilent) return false;
  log_warning("stream", fmt::format("{}: {} is silent: {} is followed now", protocol_,
                                    address_text(*sender_), address_text(sender)));
  sender_ = sender;
  others_ = 0;
  return true;
}

void FollowedSender::warn_of_number(int number, int port) {
  number_warned_ = true;
  log_warning("stream",
              fmt::format("{}: {} {} and {} send to port {}: {} came first and is "
                          "followed; name one, like {},{}",
                          protocol_, many_, *number_, number, port, *number_, port, *number_));
}

void FollowedSender::warn_of_sender(std::uint32_t sender, int port) {
  sender_warned_ = true;
  log_warning("stream",
              fmt::format("{}: {} and {} send as {} to port {}: {} came first and is "
                          "followed; name one, like {},{}@{}",
                          protocol_, address_text(*sender_), address_text(sender), *number_, port,
                          address_text(*sender_), port, *number_, address_text(*sender_)));
}

}  // namespace mixrig::stream
