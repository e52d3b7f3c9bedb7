// SPDX-License-Identifier: Apache-2.0
#include "tests/support/genicam/gvsp_sender.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include <sys/socket.h>
#include <unistd.h>

namespace mixrig::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kLeader = 1, kTrailer = 2, kPayload = 3, kMultipart = 7;
constexpr std::uint32_t kImage = 1, kChunks = 0x4000, kMultipartPayload = 0x0A;
constexpr std::size_t kIpUdp = 28, kHeader = 8, kExtendedHeader = 20, kPartHeader = 8;
constexpr std::size_t kMostUnread = 60000;  ///< bytes in the receiver's queue; the kernel allows
                                            ///< 212992 with its own overhead

void put(Bytes& bytes, std::uint64_t value, int count) {
  for (int i = count - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

Bytes header(std::uint16_t id, std::uint32_t kind, std::uint32_t packet) {
  Bytes bytes;
  put(bytes, 0, 2), put(bytes, id, 2), put(bytes, kind << 24 | packet, 4);
  return bytes;
}

/// A packet header with a 64-bit id; that of a leader also has the number of parts.
Bytes extended_header(std::uint64_t id, std::uint32_t kind, std::uint32_t packet,
                      std::size_t parts) {
  Bytes bytes;
  put(bytes, 0, 2), put(bytes, 0, 2), put(bytes, 0x80000000U | kind << 24 | parts, 4);
  put(bytes, id, 8), put(bytes, packet, 4);
  return bytes;
}

void put_geometry(Bytes& bytes, const Size& size) {
  put(bytes, static_cast<std::uint64_t>(size.width), 4);
  put(bytes, static_cast<std::uint64_t>(size.height), 4);
  put(bytes, 0, 4), put(bytes, 0, 4), put(bytes, 0, 2), put(bytes, 0, 2);
}

void put_part(Bytes& bytes, const GvspPicture& part) {
  put(bytes, part.data_type, 2);
  put(bytes, part.bytes.size(), 6);
  put(bytes, part.code, 4);
  put(bytes, 0, 2), put(bytes, 0, 1), put(bytes, 0, 1), put(bytes, 0, 4);
  put(bytes, part.purpose, 2), put(bytes, 0, 2);
  put_geometry(bytes, part.size);
  put(bytes, 0, 4);
}

/// Bytes that wait in the socket of this machine that receives on `port`; 0 where there is none.
std::size_t waiting_bytes(std::uint16_t port) {
  std::ifstream file("/proc/net/udp");
  std::string line;
  while (std::getline(file, line)) {
    unsigned local = 0;
    unsigned long waiting = 0;
    if (std::sscanf(line.c_str(), " %*d: %*x:%x %*x:%*x %*x %*x:%lx", &local, &waiting) == 2 &&
        local == port)
      return waiting;
  }
  return 0;
}

}  // namespace

GvspSender::GvspSender() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
GvspSender::~GvspSender() { ::close(socket_); }

void GvspSender::send(const GvspHost& host, const Bytes& packet) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(host.port);
  to.sin_addr.s_addr = htonl(host.address);
  unread_bytes_ += packet.size();
  if (unread_bytes_ > kMostUnread / 4) {
    for (int i = 0; i < 5000 && waiting_bytes(host.port) > kMostUnread; ++i)
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    unread_bytes_ = 0;
  }
  ::sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to),
           sizeof to);
}

void GvspSender::send_picture(const GvspHost& host, std::uint16_t id, std::uint64_t stamp_ns,
                              const GvspPicture& picture, std::span<const std::uint8_t> chunks) {
  const std::uint32_t type = kImage | (chunks.empty() ? 0 : kChunks);
  Bytes leader = header(id, kLeader, 0);
  put(leader, type, 4), put(leader, stamp_ns, 8), put(leader, picture.code, 4);
  put_geometry(leader, picture.size);
  send(host, leader);
  Bytes all(picture.bytes.begin(), picture.bytes.end());
  all.insert(all.end(), chunks.begin(), chunks.end());
  const std::size_t room = host.packet_bytes - kIpUdp - kHeader;
  std::uint32_t number = 1;
  for (std::size_t at = 0; at < all.size(); at += room, ++number) {
    Bytes block = header(id, kPayload, number);
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at);
    block.insert(block.end(), begin,
                 begin + static_cast<std::ptrdiff_t>(std::min(room, all.size() - at)));
    send(host, block);
  }
  Bytes trailer = header(id, kTrailer, number);
  put(trailer, type, 4), put(trailer, static_cast<std::uint64_t>(picture.size.height), 4);
  send(host, trailer);
}

void GvspSender::send_parts(const GvspHost& host, std::uint64_t id, std::uint64_t stamp_ns,
                            std::span<const GvspPicture> parts) {
  Bytes leader = extended_header(id, kLeader, 0, parts.size());
  put(leader, kMultipartPayload, 4), put(leader, stamp_ns, 8);
  for (const GvspPicture& part : parts) put_part(leader, part);
  send(host, leader);
  const std::size_t room = host.packet_bytes - kIpUdp - kExtendedHeader - kPartHeader;
  std::uint32_t number = 1;
  std::size_t before = 0;  // offsets count from the first part
  for (std::size_t i = 0; i < parts.size(); before += parts[i].bytes.size(), ++i)
    for (std::size_t at = 0; at < parts[i].bytes.size(); at += room, ++number) {
      const auto bytes = parts[i].bytes.subspan(at, std::min(room, parts[i].bytes.size() - at));
      Bytes block = extended_header(id, kMultipart, number, 0);
      put(block, i, 1), put(block, 0, 1), put(block, before + at, 6);
      block.insert(block.end(), bytes.begin(), bytes.end());
      send(host, block);
    }
  Bytes trailer = extended_header(id, kTrailer, number, 0);
  put(trailer, kMultipartPayload, 4), put(trailer, 0, 4);
  send(host, trailer);
}

}  // namespace mixrig::test
