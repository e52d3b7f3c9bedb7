// SPDX-License-Identifier: Apache-2.0
#include "extras/kinect2/libusb_streams.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <libusb.h>

#include "hal/linux/libusb_transfers.h"

namespace mixrig::device {
namespace {

constexpr std::uint16_t kMicrosoft = 0x045E;
constexpr std::array<std::uint16_t, 2> kKinect2Products{0x02D8, 0x02C4};
constexpr std::array<int, 2> kInterfaces{0, 1};  ///< commands and colour; infrared
constexpr unsigned kStreamsTimeout_ms = 1000;

/// Serial number of a device; empty where it cannot be read.
std::string serial_of(libusb_device* device) {
  libusb_device_descriptor descriptor{};
  libusb_device_handle* handle = nullptr;
  if (libusb_get_device_descriptor(device, &descriptor) != 0 || libusb_open(device, &handle) != 0)
    return {};
  std::array<unsigned char, 128> text{};
  const int n = libusb_get_string_descriptor_ascii(handle, descriptor.iSerialNumber, text.data(),
                                                   static_cast<int>(text.size()));
  libusb_close(handle);
  return {text.begin(), text.begin() + std::max(n, 0)};
}

bool is_kinect2(libusb_device* device) {
  libusb_device_descriptor d{};
  return libusb_get_device_descriptor(device, &d) == 0 && d.idVendor == kMicrosoft &&
         std::find(kKinect2Products.begin(), kKinect2Products.end(), d.idProduct) !=
             kKinect2Products.end();
}

class LibusbKinect2 final : public UsbStreams {
 public:
  explicit LibusbKinect2(std::string serial)
      : serial_(std::move(serial)), name_("kinect2:" + serial_) {}
  ~LibusbKinect2() override;
  Result<void> init();

  Result<void> open() override;
  void close() override;
  Result<void> request(const UsbRequest& request) override;
  Result<void> set_alternate(int interface, int setting) override;
  Result<void> write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::uint8_t endpoint, std::span<std::uint8_t> out) override;
  Result<void> submit(std::span<const StreamPipe> pipes) override;
  void cancel() override;
  BulkState pump(Duration timeout, const StreamSink& sink) override;

 private:
  Result<void> allocate(std::span<const StreamPipe> pipes);
  Result<void> find();
  static void LIBUSB_CALL on_transfer(libusb_transfer* transfer);
  void give(libusb_transfer* transfer);
  Error failed(const std::string& what, int code) const;

  std::string serial_, name_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  LibusbTransfers transfers_;
  std::vector<std::uint8_t> memory_;
  const StreamSink* sink_ = nullptr;  ///< set while pump() runs
};

LibusbKinect2::~LibusbKinect2() {
  close();
  for (libusb_transfer* transfer : std::exchange(transfers_.all(), {}))
    libusb_free_transfer(transfer);
  if (context_ != nullptr) libusb_exit(context_);
}

Error LibusbKinect2::failed(const std::string& what, int code) const {
  const bool missing = code == LIBUSB_ERROR_NO_DEVICE || code == LIBUSB_ERROR_NOT_FOUND;
  return Error{missing ? ErrorCode::kNotFound : ErrorCode::kDevice,
               name_ + ": " + what + " failed: " + libusb_strerror(code)};
}

Result<void> LibusbKinect2::init() {
  if (const int code = libusb_init(&context_); code != 0)
    return Error{ErrorCode::kIo, failed("starting libusb", code).context};
  return {};
}

Result<void> LibusbKinect2::find() {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context_, &list);
  std::string there;
  std::vector<libusb_device*> fitting;
  for (ssize_t i = 0; i < count; ++i) {
    if (!is_kinect2(list[i])) continue;
    const std::string serial = serial_of(list[i]);
    there +=
        " " + (serial.empty() ? std::string("(no right to open it: install udev rules)") : serial);
    if (serial_.empty() || serial == serial_) fitting.push_back(list[i]);
  }
  int code = LIBUSB_ERROR_NOT_FOUND;
  if (fitting.size() == 1) code = libusb_open(fitting[0], &handle_);
  if (count >= 0) libusb_free_device_list(list, 1);
  if (fitting.size() > 1)
    return Error{ErrorCode::kUsage, name_ + ": several are connected, give one's serial:" + there};
  if (fitting.empty())
    return Error{ErrorCode::kNotFound, name_ + ": not connected; there is:" +
                                           (there.empty() ? " none, check power "
                                                            "supply and USB 3 port"
                                                          : there)};
  return code == 0 ? Result<void>() : Result<void>(failed("opening it", code));
}

Result<void> LibusbKinect2::open() {
  if (handle_ != nullptr) return {};
  MIXRIG_TRY(find());
  int configuration = 0;
  int code = libusb_get_configuration(handle_, &configuration);
  if (code == 0 && configuration != 1) code = libusb_set_configuration(handle_, 1);
  for (const int interface : kInterfaces)
    if (code == 0) code = libusb_claim_interface(handle_, interface);
  if (code == 0) return {};
  close();
  return failed("claiming it (does another program use it?)", code);
}

void LibusbKinect2::close() {
  if (handle_ == nullptr) return;
  cancel();
  for (const int interface : kInterfaces) (void)libusb_release_interface(handle_, interface);
  libusb_close(std::exchange(handle_, nullptr));
}

Result<void> LibusbKinect2::request(const UsbRequest& r) {
  if (handle_ == nullptr) return failed("a request", LIBUSB_ERROR_NO_DEVICE);
  const int code = libusb_control_transfer(handle_, r.type, r.request, r.value, r.index, nullptr, 0,
                                           kStreamsTimeout_ms);
  return code >= 0 ? Result<void>() : Result<void>(failed("a request", code));
}

Result<void> LibusbKinect2::set_alternate(int interface, int setting) {
  if (handle_ == nullptr) return failed("selecting a setting", LIBUSB_ERROR_NO_DEVICE);
  const int code = libusb_set_interface_alt_setting(handle_, interface, setting);
  return code == 0 ? Result<void>() : Result<void>(failed("selecting a setting", code));
}

Result<void> LibusbKinect2::write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
  if (handle_ == nullptr) return failed("a command", LIBUSB_ERROR_NO_DEVICE);
  int sent = 0;
  auto* data = const_cast<std::uint8_t*>(bytes.data());  // libusb only reads it
  const int code = libusb_bulk_transfer(handle_, endpoint, data, static_cast<int>(bytes.size()),
                                        &sent, kStreamsTimeout_ms);
  if (code == 0 && sent == static_cast<int>(bytes.size())) return {};
  return failed("a command", code != 0 ? code : LIBUSB_ERROR_IO);
}

Result<std::size_t> LibusbKinect2::read(std::uint8_t endpoint, std::span<std::uint8_t> out) {
  if (handle_ == nullptr) return failed("an answer", LIBUSB_ERROR_NO_DEVICE);
  int got = 0;
  const int code = libusb_bulk_transfer(handle_, endpoint, out.data(), static_cast<int>(out.size()),
                                        &got, kStreamsTimeout_ms);
  if (code == 0) return static_cast<std::size_t>(got);
  return failed("an answer", code);
}

Result<void> LibusbKinect2::allocate(std::span<const StreamPipe> pipes) {
  if (!transfers_.all().empty()) return {};
  std::size_t bytes = 0;
  for (const StreamPipe& pipe : pipes)
    bytes += pipe.packet_bytes * static_cast<std::size_t>(pipe.packets * pipe.transfers);
  memory_.resize(bytes);
  std::uint8_t* memory = memory_.data();
  for (const StreamPipe& pipe : pipes)
    for (int i = 0; i < pipe.transfers; ++i) {
      libusb_transfer* transfer = libusb_alloc_transfer(pipe.isochronous ? pipe.packets : 0);
      if (transfer == nullptr) return failed("allocating transfers", LIBUSB_ERROR_NO_MEM);
      const std::size_t length = pipe.packet_bytes * static_cast<std::size_t>(pipe.packets);
      if (pipe.isochronous) {
        libusb_fill_iso_transfer(transfer, nullptr, pipe.endpoint, memory, static_cast<int>(length),
                                 pipe.packets, on_transfer, this, 0);
        libusb_set_iso_packet_lengths(transfer, static_cast<unsigned>(pipe.packet_bytes));
      } else {
        libusb_fill_bulk_transfer(transfer, nullptr, pipe.endpoint, memory,
                                  static_cast<int>(length), on_transfer, this, 0);
      }
      transfers_.all().push_back(transfer);
      memory += length;
    }
  return {};
}

Result<void> LibusbKinect2::submit(std::span<const StreamPipe> pipes) {
  if (handle_ == nullptr) return failed("submitting a transfer", LIBUSB_ERROR_NO_DEVICE);
  MIXRIG_TRY(allocate(pipes));
  transfers_.begin();
  for (libusb_transfer* transfer : transfers_.all()) {
    transfer->dev_handle = handle_;
    if (const int code = transfers_.submit(transfer); code != 0) {
      cancel();
      return failed("submitting a transfer (usbfs_memory_mb of the kernel must be 64 or more)",
                    code);
    }
  }
  return {};
}

void LibusbKinect2::cancel() { transfers_.cancel(context_); }

BulkState LibusbKinect2::pump(Duration timeout, const StreamSink& sink) {
  sink_ = &sink;
  const BulkState state = transfers_.pump(context_, timeout);
  sink_ = nullptr;
  return state;
}

/// Runs inside libusb_handle_events, on the thread that pumps.
void LIBUSB_CALL LibusbKinect2::on_transfer(libusb_transfer* transfer) {
  auto& self = *static_cast<LibusbKinect2*>(transfer->user_data);
  self.transfers_.returned(transfer, [&self](libusb_transfer* t) { self.give(t); });
}

void LibusbKinect2::give(libusb_transfer* transfer) {
  if (sink_ == nullptr) return;
  if (transfer->type != LIBUSB_TRANSFER_TYPE_ISOCHRONOUS) {
    (*sink_)({transfer->endpoint,
              {transfer->buffer, static_cast<std::size_t>(transfer->actual_length)},
              true});
    return;
  }
  const std::uint8_t* at = transfer->buffer;
  for (int i = 0; i < transfer->num_iso_packets; ++i) {
    const libusb_iso_packet_descriptor& packet = transfer->iso_packet_desc[i];
    const bool good = packet.status == LIBUSB_TRANSFER_COMPLETED;
    (*sink_)({transfer->endpoint, {at, good ? std::size_t{packet.actual_length} : 0}, good});
    at += packet.length;
  }
}

}  // namespace

Result<std::unique_ptr<UsbStreams>> make_libusb_kinect2(const std::string& serial) {
  auto usb = std::make_unique<LibusbKinect2>(serial);
  MIXRIG_TRY(usb->init());
  return std::unique_ptr<UsbStreams>(std::move(usb));
}

std::vector<std::string> list_kinect2() {
  std::vector<std::string> serials;
  libusb_context* context = nullptr;
  if (libusb_init(&context) != 0) return serials;
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  for (ssize_t i = 0; i < count; ++i)
    if (is_kinect2(list[i])) serials.push_back(serial_of(list[i]));
  if (count >= 0) libusb_free_device_list(list, 1);
  libusb_exit(context);
  return serials;
}

}  // namespace mixrig::device
