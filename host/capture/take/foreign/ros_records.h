// SPDX-License-Identifier: Apache-2.0
// The container of ROS 1 bags, format 2.0 (wiki.ros.org/Bags/Format/2.0). Private to this module.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "hal/base/result.h"

namespace mixrig::take {

struct BagConnection {
  std::string topic, type;
};
struct BagMessage {
  const BagConnection& from;
  std::span<const std::uint8_t> bytes;
};

/// How a bag begins.
inline constexpr std::string_view kBagBegin = "#ROSBAG V2.0\n";

/// Calls use() for each message in the order of the file until it fails. Returns whether the bag is
/// whole: a record that is cut off ends it. Pure. Errors: kFormat for another file, kUnsupported
/// for compressed chunks, those of use().
Result<bool> each_message(std::span<const std::uint8_t> bag,
                          const std::function<Result<void>(const BagMessage&)>& use);

}  // namespace mixrig::take
