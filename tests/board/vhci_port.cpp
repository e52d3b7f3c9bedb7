// SPDX-License-Identifier: Apache-2.0
#include "tests/board/vhci_port.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace mixrig::board {
namespace {

constexpr const char* kAttach = "/sys/devices/platform/vhci_hcd.0/attach";
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr int kCancelled = -104;  // ECONNRESET, which the kernel expects for an unlinked transfer
constexpr std::size_t kLongestTransfer = 2 << 20;
constexpr std::uint32_t kNoPackets = 0xFFFFFFFF, kMostPackets = 1024;
constexpr std::uint8_t kGetStatus = 0, kClearFeature = 1, kGetDescriptor = 6, kGetConfiguration = 8,
                       kSetConfiguration = 9, kGetInterface = 10, kSetInterface = 11;

/// The kernel's usbip_iso_packet_descriptor: big-endian words.
struct IsoPacket {
  std::uint32_t offset, length, actual, status;
};

HostTime now() { return SystemClock().now(); }

}  // namespace

/// The kernel's usbip_header: big-endian words, except the setup packet.
struct VhciPort::Header {
  std::uint32_t command, sequence, device, in, endpoint;
  union {
    struct {
      std::uint32_t flags, length, first, packets, interval;
      std::uint8_t setup[8];
    } submit;
    struct {
      std::uint32_t status, actual, first, packets, errors, padding[2];
    } answer;
    std::uint32_t unlinked;
  };
};

VhciPort::VhciPort(int number, UsbDevice& device)
    : number_(number), device_(device), event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

VhciPort::~VhciPort() {
  unplug();
  ::close(event_);
}

Result<void> VhciPort::plug() {
  static_assert(sizeof(Header) == 48);
  unplug();
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return system_error(ErrorCode::kIo, "cannot make a socket pair", errno);
  const auto attached = attach(ends[1]);
  ::close(ends[1]);
  if (!attached) {
    ::close(ends[0]);
    return attached;
  }
  socket_ = ends[0];
  stop_ = false;
  for (auto& queue : pending_) queue.clear();
  buffer_.resize(kLongestTransfer);
  thread_ = std::thread([this] { serve(); });
  return {};
}

/// Gives the kernel its end of the line. A port stays busy for a while after an unplug.
Result<void> VhciPort::attach(int kernel_end) {
  const std::string text = std::to_string(number_) + " " + std::to_string(kernel_end) + " " +
                           std::to_string(0x10000 + number_ + 2) + " " +
                           std::to_string(static_cast<int>(device_.descriptors().speed));
  int reason = 0;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const int file = ::open(kAttach, O_WRONLY | O_CLOEXEC);
    if (file < 0)
      return system_error(ErrorCode::kNotFound, "no vhci-hcd: modprobe vhci-hcd", errno);
    const bool done = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    reason = errno;
    ::close(file);
    if (done) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return system_error(ErrorCode::kIo,
                      "cannot plug into virtual USB port " + std::to_string(number_), reason);
}

void VhciPort::unplug() {
  if (!thread_.joinable()) return;
  stop_ = true;
  wake();
  thread_.join();
  ::close(std::exchange(socket_, -1));
}

void VhciPort::wake() {
  const std::uint64_t one = 1;
  (void)!::write(event_, &one, sizeof one);
}

void VhciPort::serve() {
  while (!stop_) {
    if (!pump()) break;
    // Without a waiting transfer no data is produced: the line is closed or the stream stopped.
    const bool waiting = std::any_of(pending_.begin(), pending_.end(),
                                     [](const auto& queue) { return !queue.empty(); });
    const auto next = waiting ? device_.next_event() : std::nullopt;
    timespec timeout{};
    if (next) {
      const auto wait = std::max(Duration(0), *next - now());
      timeout.tv_sec = static_cast<time_t>(wait.count() / 1'000'000'000);
      timeout.tv_nsec = static_cast<long>(wait.count() % 1'000'000'000);
    }
    pollfd wait[] = {{socket_, POLLIN, 0}, {event_, POLLIN, 0}};
    if (::ppoll(wait, 2, next ? &timeout : nullptr, nullptr) < 0 && errno != EINTR) break;
    std::uint64_t events = 0;
    if (wait[1].revents != 0) (void)!::read(event_, &events, sizeof events);
    if (wait[0].revents != 0 && !take_request()) break;
  }
}

bool VhciPort::read_all(void* to, std::size_t bytes) {
  auto* at = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t got = ::read(socket_, at, bytes);
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

bool VhciPort::write_all(const void* from, std::size_t bytes) {
  const auto* at = static_cast<const char*>(from);
  while (bytes > 0) {
    const ssize_t put = ::send(socket_, at, bytes, MSG_NOSIGNAL);
    if (put <= 0) return false;
    at += put;
    bytes -= static_cast<std::size_t>(put);
  }
  return true;
}

bool VhciPort::take_request() {
  Header header;
  if (!read_all(&header, sizeof header)) return false;
  return ntohl(header.command) == kUnlink ? unlink(header) : submit(header);
}

bool VhciPort::submit(const Header& header) {
  const std::uint32_t sequence = ntohl(header.sequence), length = ntohl(header.submit.length);
  const auto endpoint = static_cast<int>(ntohl(header.endpoint));
  const bool in = ntohl(header.in) != 0;
  if (length > kLongestTransfer || endpoint >= kEndpoints) return false;
  if (!in && length > 0 && !read_all(buffer_.data(), length)) return false;
  if (endpoint == 0) {
    const std::uint8_t* s = header.submit.setup;
    const auto word = [&](int at) { return static_cast<std::uint16_t>(s[at] | s[at + 1] << 8); };
    const UsbSetup setup{s[0], s[1], word(2), word(4), word(6)};
    const int done = answer(setup, std::span(buffer_).first(length));
    const auto actual = static_cast<std::size_t>(std::max(0, done));
    return complete(sequence, std::min(0, done), in ? actual : length, in);
  }
  if (in) {
    Transfer transfer{sequence, length};
    const std::uint32_t packets = ntohl(header.submit.packets);
    if (packets != kNoPackets && packets > 0 && !read_packets(packets, length, transfer.packets))
      return false;
    pending_[static_cast<std::size_t>(endpoint)].push_back(std::move(transfer));
    return true;
  }
  device_.receive(endpoint, std::span<const std::uint8_t>(buffer_).first(length));
  return complete(sequence, 0, length, false);
}

/// Reads the packet lengths of an isochronous transfer, which follow its header.
bool VhciPort::read_packets(std::uint32_t count, std::uint32_t length,
                            std::vector<std::uint32_t>& to) {
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < count && count <= kMostPackets; ++i) {
    IsoPacket packet;
    if (!read_all(&packet, sizeof packet)) return false;
    to.push_back(ntohl(packet.length));
    sum += to.back();
  }
  return !to.empty() && sum <= length;
}

bool VhciPort::unlink(const Header& header) {
  const std::uint32_t wanted = ntohl(header.unlinked);
  int status = 0;  // the transfer is complete already
  for (auto& queue : pending_) {
    const auto found = std::find_if(queue.begin(), queue.end(),
                                    [&](const Transfer& t) { return t.sequence == wanted; });
    if (found == queue.end()) continue;
    queue.erase(found);
    status = kCancelled;
  }
  Header reply{};
  reply.command = htonl(kUnlinked);
  reply.sequence = header.sequence;
  reply.answer.status = htonl(static_cast<std::uint32_t>(status));
  return write_all(&reply, sizeof reply);
}

bool VhciPort::complete(std::uint32_t sequence, int status, std::size_t actual, bool with_data) {
  Header reply{};
  reply.command = htonl(kSubmitted);
  reply.sequence = htonl(sequence);
  reply.answer.status = htonl(static_cast<std::uint32_t>(status));
  reply.answer.actual = htonl(static_cast<std::uint32_t>(actual));
  if (!write_all(&reply, sizeof reply)) return false;
  return !with_data || actual == 0 || write_all(buffer_.data(), actual);
}

/// Gives every waiting transfer to the device while it has data to send.
bool VhciPort::pump() {
  for (int endpoint = 1; endpoint < kEndpoints; ++endpoint) {
    auto& queue = pending_[static_cast<std::size_t>(endpoint)];
    while (!queue.empty()) {
      if (!queue.front().packets.empty()) {
        bool waits = false;
        if (!send_packets(endpoint, queue.front(), waits)) return false;
        if (waits) break;
        queue.pop_front();
        continue;
      }
      const Transfer transfer = queue.front();
      const int done = device_.transmit(endpoint, std::span(buffer_).first(transfer.length), now());
      if (done == kUsbWait) break;
      queue.pop_front();
      const auto actual = static_cast<std::size_t>(std::max(0, done));
      if (!complete(transfer.sequence, std::min(0, done), actual, true)) return false;
    }
  }
  return true;
}

/// Sends the data without the gaps of short packets, then the packets' descriptors.
bool VhciPort::send_packets(int endpoint, const Transfer& transfer, bool& waits) {
  std::vector<IsoPacket> packets;
  std::size_t offset = 0, sent = 0;
  std::uint32_t errors = 0;
  for (const std::uint32_t length : transfer.packets) {
    int done = waits ? kUsbWait
                     : device_.transmit(endpoint, std::span(buffer_).subspan(sent, length), now());
    waits = waits || done == kUsbWait;
    if (waits && packets.empty()) return true;
    const bool lost = done == kUsbLost;
    done = std::max(0, done);
    errors += lost ? 1 : 0;
    packets.push_back({htonl(static_cast<std::uint32_t>(offset)), htonl(length),
                       htonl(static_cast<std::uint32_t>(done)),
                       htonl(static_cast<std::uint32_t>(lost ? kUsbLost : 0))});
    offset += length;
    sent += static_cast<std::size_t>(done);
  }
  waits = false;  // this transfer is complete
  Header reply{};
  reply.command = htonl(kSubmitted);
  reply.sequence = htonl(transfer.sequence);
  reply.answer.actual = htonl(static_cast<std::uint32_t>(sent));
  reply.answer.packets = htonl(static_cast<std::uint32_t>(packets.size()));
  reply.answer.errors = htonl(errors);
  return write_all(&reply, sizeof reply) && write_all(buffer_.data(), sent) &&
         write_all(packets.data(), packets.size() * sizeof(IsoPacket));
}

int VhciPort::answer(const UsbSetup& setup, std::span<std::uint8_t> data) {
  if ((setup.type & 0x60) != 0) return device_.control(setup, data);
  switch (setup.request) {
    case kGetDescriptor:
      return describe(setup, data);
    case kGetStatus:
    case kGetConfiguration:
    case kGetInterface:
      std::fill(data.begin(), data.end(), 0);
      if (setup.request == kGetConfiguration && !data.empty()) data[0] = 1;
      return static_cast<int>(data.size());
    case kClearFeature:
      device_.clear_halt();
      return 0;
    case kSetConfiguration:
      device_.configured();
      return 0;
    case kSetInterface:
      device_.selected(setup.index, setup.value);
      return 0;
    default:
      return 0;  // SET_ADDRESS, SET_FEATURE, SET_ISOCH_DELAY
  }
}

int VhciPort::describe(const UsbSetup& setup, std::span<std::uint8_t> out) const {
  const UsbDescriptors& own = device_.descriptors();
  std::vector<std::uint8_t> bytes;
  const auto index = static_cast<std::size_t>(setup.value & 0xFF);
  switch (setup.value >> 8) {
    case 1:
      bytes = own.device;
      break;
    case 2:
      bytes = own.configuration;
      break;
    case 3:
      if (index > own.strings.size()) return kUsbStall;
      bytes = {0, 3};
      if (index == 0) bytes.insert(bytes.end(), {0x09, 0x04});  // US English
      if (index > 0)
        for (const char letter : own.strings[index - 1])
          bytes.insert(bytes.end(), {static_cast<std::uint8_t>(letter), 0});
      bytes[0] = static_cast<std::uint8_t>(bytes.size());
      break;
    default:
      return kUsbStall;
  }
  const std::size_t count = std::min(out.size(), bytes.size());
  std::copy_n(bytes.begin(), count, out.begin());
  return static_cast<int>(count);
}

}  // namespace mixrig::board
