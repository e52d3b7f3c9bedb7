// SPDX-License-Identifier: Apache-2.0
#include "tests/board/uvc_device.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace mixrig::board {
namespace {

constexpr int kCamera = 1, kProcessing = 2, kOutput = 3, kTrigger = 4;  // units
constexpr int kTriggerMode = 1;  // selector of the trigger unit
constexpr std::size_t kPayload = 16384, kPayloadHeader = 2;
constexpr std::uint32_t kDefaultInterval = 333333;  // in units of 100 ns: 30 Hz
constexpr std::uint8_t kGuid[16] = {'m', 'i', 'x', 'r', 'i', 'g', '-', 't',
                                    'r', 'i', 'g', 'g', 'e', 'r', '-', '1'};
constexpr std::uint8_t kBlack = 16, kWhite = 235, kNoColor = 128;

using Bytes = std::vector<std::uint8_t>;

/// Appends little-endian numbers to a descriptor.
struct Writer {
  Bytes& out;
  Writer& u8(std::initializer_list<int> values) {
    for (const int v : values) out.push_back(static_cast<std::uint8_t>(v));
    return *this;
  }
  Writer& u16(std::size_t v) { return u8({static_cast<int>(v & 0xFF), static_cast<int>(v >> 8)}); }
  Writer& u32(std::size_t v) { return u16(v & 0xFFFF).u16(v >> 16); }
  Writer& raw(const Bytes& v) {
    out.insert(out.end(), v.begin(), v.end());
    return *this;
  }
};

/// VideoControl interface: camera -> processing -> extension -> USB.
Bytes control_interface() {
  Bytes units;
  Writer u{units};
  // exposure mode, exposure, focus
  u.u8({18, 0x24, 2, kCamera}).u16(0x0201).u8({0, 0}).u16(0).u16(0).u16(0).u8({3, 0x2A, 0, 0});
  // white balance temperature, gain
  u.u8({13, 0x24, 5, kProcessing, kCamera}).u16(0).u8({3, 0x40, 0x02, 0, 0, 0});
  u.u8({26, 0x24, 6, kTrigger}).raw(Bytes(kGuid, kGuid + 16)).u8({1, 1, kProcessing, 1, 1, 0});
  u.u8({9, 0x24, 3, kOutput}).u16(0x0101).u8({0, kTrigger, 0});
  Bytes out;
  Writer w{out};
  w.u8({9, 4, 0, 0, 0, 14, 1, 0, 2});
  w.u8({13, 0x24, 1}).u16(0x0110).u16(13 + units.size()).u32(48'000'000).u8({1, 1}).raw(units);
  return out;
}

/// VideoStreaming interface: YUY2 of one size at 60, 30, 25 and 10 Hz over bulk endpoint 1.
Bytes stream_interface(Size size) {
  const std::size_t bytes = size.area() * 2;
  Bytes formats;
  Writer f{formats};
  f.u8({27,   0x24, 4,    1, 1, 'Y',  'U', 'Y',  '2',  0,   0,
        0x10, 0,    0x80, 0, 0, 0xAA, 0,   0x38, 0x9B, 0x71})
      .u8({16, 1, 0, 0, 0, 0});
  f.u8({42, 0x24, 5, 1, 0}).u16(static_cast<std::size_t>(size.width));
  f.u16(static_cast<std::size_t>(size.height)).u32(bytes * 8 * 10).u32(bytes * 8 * 60).u32(bytes);
  f.u32(kDefaultInterval).u8({4}).u32(166666).u32(kDefaultInterval).u32(400000).u32(1000000);
  Bytes out;
  Writer w{out};
  w.u8({9, 4, 1, 0, 1, 14, 2, 0, 0});
  w.u8({14, 0x24, 1, 1}).u16(14 + formats.size()).u8({0x81, 0, kOutput, 0, 0, 0, 1, 0});
  w.raw(formats).u8({7, 5, 0x81, 2}).u16(512).u8({0});
  return out;
}

UsbDescriptors describe(Size size) {
  UsbDescriptors d;
  d.device = {18, 1, 0, 2, 0xEF, 2, 1, 64, 0x6B, 0x1D, 0x02, 0x01, 0, 1, 1, 2, 3, 1};
  Bytes body;
  Writer{body}.u8({8, 11, 0, 2, 14, 3, 0, 2}).raw(control_interface()).raw(stream_interface(size));
  Writer{d.configuration}.u8({9, 2}).u16(9 + body.size()).u8({2, 1, 0, 0x80, 250}).raw(body);
  d.strings = {"mixrig", "Virtual UVC camera", "UVC0001"};
  return d;
}

std::uint32_t word(std::span<const std::uint8_t> b) {
  return b[0] | b[1] << 8 | b[2] << 16 | static_cast<std::uint32_t>(b[3]) << 24;
}

void put_word(std::uint8_t* at, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) at[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace

int read_code(const Image<Rgb8>& picture) {
  int code = 0;
  for (int bit = 0; bit < kCodeBits; ++bit) {
    const Rgb8& middle = picture.row(kCodeBlock_px / 2)[bit * kCodeBlock_px + kCodeBlock_px / 2];
    if (middle.g > 127) code |= 1 << bit;
  }
  return code;
}

UvcDevice::UvcDevice(Size size) : size_(size), descriptors_(describe(size)) {
  ranges_ = {{{kCamera, 2}, {1, 0, 0, 9, 8}},
             {{kCamera, 4}, {4, 1, 10000, 1, 250}},
             {{kCamera, 6}, {2, 0, 255, 5, 40}},
             {{kProcessing, 4}, {2, 0, 100, 1, 10}},
             {{kProcessing, 10}, {2, 2800, 6500, 10, 4600}},
             {{kTrigger, kTriggerMode}, {1, 0, 1, 1, 0}}};
  picture_.resize(size.area() * 2);
  for (std::size_t i = 0; i < picture_.size(); i += 2) {
    picture_[i] =
        static_cast<std::uint8_t>(kBlack + i / 2 % static_cast<std::size_t>(size.width) % 200);
    picture_[i + 1] = kNoColor;
  }
  configured();
}

void UvcDevice::configured() {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, range] : ranges_) values_[key] = range.initial;
  probe_ = {0, 0, 1, 1};
  put_word(&probe_[4], kDefaultInterval);
  put_word(&probe_[18], static_cast<std::uint32_t>(size_.area() * 2));
  put_word(&probe_[22], kPayload);
  streaming_ = false;
  number_ = 0;
}

bool UvcDevice::triggered() const { return values_.at({kTrigger, kTriggerMode}) != 0; }

int UvcDevice::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
  const std::lock_guard lock(mutex_);
  if ((setup.index & 0xFF) == 1) return stream_control(setup, data);
  if (setup.index >> 8 == 0 && setup.value >> 8 == UVC_VC_REQUEST_ERROR_CODE_CONTROL &&
      !data.empty())
    return data[0] = 0, 1;
  return unit_control(setup, data);
}

int UvcDevice::stream_control(const UsbSetup& setup, std::span<std::uint8_t> data) {
  const int selector = setup.value >> 8;
  if (selector != UVC_VS_PROBE_CONTROL && selector != UVC_VS_COMMIT_CONTROL) return kUsbStall;
  if (setup.request == UVC_SET_CUR && data.size() >= 8) {
    const std::uint32_t wanted = word(data.subspan(4));
    const std::uint32_t interval = wanted < 166666 ? kDefaultInterval : wanted;
    put_word(&probe_[4], interval);
    if (selector == UVC_VS_PROBE_CONTROL) return 0;
    interval_ = Duration(interval * 100L);
    streaming_ = true;
    sent_ = 0;
    fired_.reset();
    due_ = {};
    return 0;
  }
  if (setup.request == UVC_GET_INFO && !data.empty()) return data[0] = 3, 1;
  if (setup.request == UVC_GET_LEN && data.size() >= 2) return data[0] = 34, data[1] = 0, 2;
  const std::size_t count = std::min(data.size(), probe_.size());
  std::copy_n(probe_.begin(), count, data.begin());
  return static_cast<int>(count);
}

int UvcDevice::unit_control(const UsbSetup& setup, std::span<std::uint8_t> data) {
  const Key key{setup.index >> 8, setup.value >> 8};
  const auto found = ranges_.find(key);
  if (found == ranges_.end() || data.empty()) return kUsbStall;
  const Range& range = found->second;
  std::uint8_t bytes[4] = {};
  if (setup.request == UVC_SET_CUR) {
    std::copy_n(data.begin(), std::min<std::size_t>(data.size(), 4), bytes);
    values_[key] = static_cast<int>(word(bytes));
    return 0;
  }
  int answer = 0, length = range.length;
  switch (setup.request) {
    case UVC_GET_CUR:
      answer = values_[key];
      break;
    case UVC_GET_MIN:
      answer = range.minimum;
      break;
    case UVC_GET_MAX:
      answer = range.maximum;
      break;
    case UVC_GET_RES:
      answer = range.resolution;
      break;
    case UVC_GET_DEF:
      answer = range.initial;
      break;
    case UVC_GET_INFO:
      answer = 3, length = 1;
      break;
    case UVC_GET_LEN:
      answer = range.length, length = 2;
      break;
    default:
      return kUsbStall;
  }
  put_word(bytes, static_cast<std::uint32_t>(answer));
  const std::size_t count = std::min(data.size(), static_cast<std::size_t>(length));
  std::copy_n(bytes, count, data.begin());
  return static_cast<int>(count);
}

bool UvcDevice::begin_picture(HostTime now) {
  if (triggered()) {
    if (!fired_) return false;
    number_ = *fired_;
    fired_.reset();
  } else {
    if (now < due_) return false;
    due_ = (now - due_ > 2 * interval_ ? now : due_) + interval_;
    ++number_;
  }
  if (shown_.empty())
    draw_picture();
  else
    picture_ = shown_;
  toggle_ = !toggle_;
  return true;
}

void UvcDevice::draw_picture() {
  for (int y = 0; y < kCodeBlock_px; ++y)
    for (int x = 0; x < kCodeBits * kCodeBlock_px; ++x)
      picture_[static_cast<std::size_t>(y * size_.width + x) * 2] =
          (number_ >> (x / kCodeBlock_px) & 1) != 0 ? kWhite : kBlack;
  for (int y = kCodeBlock_px; y < size_.height && !columns_.empty(); ++y)
    for (int x = 0; x < size_.width; ++x)
      picture_[static_cast<std::size_t>(y * size_.width + x) * 2] =
          columns_[static_cast<std::size_t>(x)];
}

int UvcDevice::transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) {
  const std::lock_guard lock(mutex_);
  if (endpoint != 1 || !streaming_) return kUsbWait;
  if (sent_ == 0 && !begin_picture(now)) return kUsbWait;
  const std::size_t count =
      std::min({room.size() - kPayloadHeader, kPayload - kPayloadHeader, picture_.size() - sent_});
  const bool last = sent_ + count == picture_.size();
  room[0] = kPayloadHeader;
  room[1] = static_cast<std::uint8_t>(0x80 | (toggle_ ? 1 : 0) | (last ? 2 : 0));
  std::copy_n(picture_.begin() + static_cast<std::ptrdiff_t>(sent_), count,
              room.begin() + kPayloadHeader);
  sent_ = last ? 0 : sent_ + count;
  return static_cast<int>(count + kPayloadHeader);
}

std::optional<HostTime> UvcDevice::next_event() {
  const std::lock_guard lock(mutex_);
  if (!streaming_ || triggered()) return std::nullopt;
  return due_;
}

void UvcDevice::fire(std::uint32_t number) {
  const std::lock_guard lock(mutex_);
  if (miss_every_ > 0 && ++edges_ % miss_every_ == 0) return;
  if (streaming_ && triggered()) fired_ = number;
}

void UvcDevice::show(std::vector<std::uint8_t> columns) {
  columns.resize(static_cast<std::size_t>(size_.width), kBlack);
  const std::lock_guard lock(mutex_);
  columns_ = std::move(columns);
}

void UvcDevice::show_picture(std::vector<std::uint8_t> yuyv) {
  yuyv.resize(picture_.size(), kNoColor);
  const std::lock_guard lock(mutex_);
  shown_ = std::move(yuyv);
}

void UvcDevice::miss_every(int n) {
  const std::lock_guard lock(mutex_);
  miss_every_ = n;
}

int UvcDevice::value(int unit, int selector) const {
  const std::lock_guard lock(mutex_);
  return values_.at({unit, selector});
}

Result<void> map_trigger_control(const std::string& node) {
  const int file = ::open(node.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return system_error(ErrorCode::kIo, "cannot open " + node, errno);
  uvc_xu_control_mapping mapping{};
  mapping.id = V4L2_CID_USER_BASE + 0x1F00;
  std::memcpy(mapping.name, "Trigger Mode", 13);
  std::memcpy(mapping.entity, kGuid, sizeof kGuid);
  mapping.selector = kTriggerMode;
  mapping.size = 8;
  mapping.v4l2_type = V4L2_CTRL_TYPE_BOOLEAN;
  mapping.data_type = UVC_CTRL_DATA_TYPE_BOOLEAN;
  const int mapped = ::ioctl(file, UVCIOC_CTRL_MAP, &mapping);
  const int reason = errno;
  ::close(file);
  if (mapped == 0 || reason == EEXIST) return {};
  return system_error(ErrorCode::kDevice, node + ": trigger control cannot be mapped", reason);
}

}  // namespace mixrig::board
