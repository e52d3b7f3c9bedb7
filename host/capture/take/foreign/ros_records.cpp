// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/foreign/ros_records.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "host/capture/take/foreign/ros_messages.h"

namespace mixrig::take {
namespace {

enum Op : std::uint8_t { kMessageData = 0x02, kChunk = 0x05, kConnection = 0x07 };
constexpr std::size_t kMostConnections = 4096;

/// "name=value" fields of a header, each behind its length.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::optional<std::span<const std::uint8_t>> find(std::string_view name) const {
    RosReader rest(bytes_);
    while (true) {
      const auto field = rest.block();
      if (!rest.ok()) return std::nullopt;
      if (field.size() > name.size() && field[name.size()] == '=' &&
          std::equal(name.begin(), name.end(), field.begin()))
        return field.subspan(name.size() + 1);
    }
  }
  std::string text(std::string_view name) const {
    const auto value = find(name);
    return value ? std::string(value->begin(), value->end()) : std::string();
  }
  std::uint32_t number(std::string_view name) const {
    return RosReader(find(name).value_or(std::span<const std::uint8_t>())).u32();
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

struct BagWalk {
  const std::function<Result<void>(const BagMessage&)>& use;
  std::map<std::uint32_t, BagConnection> connections = {};
  bool is_whole = true;

  Result<void> records(std::span<const std::uint8_t> bytes, bool in_chunk) {
    RosReader rest(bytes);
    while (!rest.at_end()) {
      const Fields head(rest.block());
      const auto data = rest.block();
      is_whole = is_whole && rest.ok();
      if (!rest.ok()) break;
      const auto op = head.find("op");
      if (!op || op->size() != 1) continue;
      MIXRIG_TRY(record((*op)[0], head, data, in_chunk));
    }
    return {};
  }

  Result<void> record(std::uint8_t op, const Fields& head, std::span<const std::uint8_t> data,
                      bool in_chunk) {
    if (op == kConnection && connections.size() < kMostConnections) {
      const Fields about(data);
      connections.try_emplace(head.number("conn"),
                              BagConnection{head.text("topic"), about.text("type")});
    }
    if (op == kMessageData)
      if (const auto at = connections.find(head.number("conn")); at != connections.end())
        return use({at->second, data});
    if (op != kChunk || in_chunk) return {};
    if (head.text("compression") == "none") return records(data, true);
    return Error{ErrorCode::kUnsupported,
                 "its chunks are compressed (" + head.text("compression") +
                     "): write it again without, by rosbag decompress FILE"};
  }
};

}  // namespace

Result<bool> each_message(std::span<const std::uint8_t> bag,
                          const std::function<Result<void>(const BagMessage&)>& use) {
  if (bag.size() < kBagBegin.size() || !std::equal(kBagBegin.begin(), kBagBegin.end(), bag.begin()))
    return Error{ErrorCode::kFormat, "is no ROS 1 bag of format 2.0"};
  BagWalk walk{use};
  MIXRIG_TRY(walk.records(bag.subspan(kBagBegin.size()), false));
  return walk.is_whole;
}

}  // namespace mixrig::take
