// SPDX-License-Identifier: Apache-2.0
// Which packets of a port belong to the camera that is followed.
#pragma once

#include <cstdint>
#include <optional>

#include "extras/broadcast/packets/udp_receiver.h"

namespace mixrig::stream {

/// Follows the number and the sender of an address; what it does not state is taken from the first
/// packet. A number is kept for good. A sender that was not stated is given up for another one with
/// the same number after kSilent packets of that one alone, as where a tracker gets a new address.
/// Warns once of other packets that the address does not exclude, and of each new sender. Not
/// thread-safe.
class FollowedSender {
 public:
  static constexpr int kSilent = 100;
  /// `protocol`, `many`: words of the warnings, such as "FreeD" and "cameras".
  FollowedSender(const char* protocol, const char* many, const ListenAddress& stated)
      : protocol_(protocol), many_(many), stated_(stated) {}

  /// Whether a packet of `number` from `sender`, received at `port`, is followed.
  bool takes(int number, std::uint32_t sender, int port);

 private:
  void warn_of_number(int number, int port);
  void warn_of_sender(std::uint32_t sender, int port);

  const char *protocol_, *many_;
  ListenAddress stated_;
  std::optional<int> number_;
  std::optional<std::uint32_t> sender_, other_;
  int others_ = 0;  ///< packets of `other_` since the last one of `sender_`
  bool number_warned_ = false, sender_warned_ = false;
};

}  // namespace mixrig::stream
