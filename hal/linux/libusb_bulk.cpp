// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/libusb_bulk.h"

#include <utility>
#include <vector>

#include <libusb.h>

#include "hal/linux/libusb_transfers.h"

namespace mixrig::device {
namespace {

constexpr int kTransfers = 8;
constexpr int kTransferBytes = 65536;
constexpr unsigned kControlTimeout_ms = 1000;
constexpr int kVendorRequest = int{LIBUSB_REQUEST_TYPE_VENDOR} | int{LIBUSB_RECIPIENT_INTERFACE};
constexpr std::uint8_t kFromDevice = LIBUSB_ENDPOINT_IN | kVendorRequest,
                       kToDevice = kVendorRequest;

class LibusbBulk final : public UsbBulk {
 public:
  LibusbBulk(const BulkAddress& address, std::string name)
      : address_(address),
        name_(std::move(name)),
        memory_(static_cast<std::size_t>(kTransfers) * kTransferBytes) {}
  ~LibusbBulk() override;
  Result<void> init();

  Result<void> open() override;
  void close() override;
  Result<std::size_t> request(std::uint8_t request, std::uint16_t value,
                              std::span<std::uint8_t> in) override;
  Result<void> submit() override;
  void cancel() override;
  BulkState pump(Duration timeout, const BulkSink& sink) override;

 private:
  static void LIBUSB_CALL on_transfer(libusb_transfer* transfer);
  void give(libusb_transfer* transfer);
  Result<void> find_pipe();
  void find_pipe(const libusb_interface_descriptor& setting);
  Error failed(const std::string& what, int code) const;

  BulkAddress address_;
  std::string name_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  int interface_ = -1;
  std::uint8_t pipe_ = 0;
  LibusbTransfers transfers_;
  std::vector<std::uint8_t> memory_;
  const BulkSink* sink_ = nullptr;  ///< set while pump() runs
};

LibusbBulk::~LibusbBulk() {
  close();
  for (libusb_transfer* transfer : std::exchange(transfers_.all(), {}))
    libusb_free_transfer(transfer);
  if (context_ != nullptr) libusb_exit(context_);
}

Error LibusbBulk::failed(const std::string& what, int code) const {
  const bool missing = code == LIBUSB_ERROR_NO_DEVICE || code == LIBUSB_ERROR_NOT_FOUND;
  return Error{missing ? ErrorCode::kNotFound : ErrorCode::kDevice,
               name_ + ": " + what + " failed: " + libusb_strerror(code)};
}

Result<void> LibusbBulk::init() {
  if (const int code = libusb_init(&context_); code != 0) return failed("starting libusb", code);
  for (int i = 0; i < kTransfers; ++i) {
    libusb_transfer* transfer = libusb_alloc_transfer(0);
    if (transfer == nullptr) return failed("allocating transfers", LIBUSB_ERROR_NO_MEM);
    transfers_.all().push_back(transfer);
  }
  return {};
}

Result<void> LibusbBulk::open() {
  if (handle_ != nullptr) return {};
  handle_ = libusb_open_device_with_vid_pid(context_, address_.vendor, address_.product);
  if (handle_ == nullptr)
    return Error{ErrorCode::kNotFound,
                 name_ + ": no such device, or no right to open it: check cable and udev rules"};
  auto found = find_pipe();
  if (!found) close();
  return found;
}

Result<void> LibusbBulk::find_pipe() {
  libusb_config_descriptor* config = nullptr;
  int code = libusb_get_active_config_descriptor(libusb_get_device(handle_), &config);
  if (code != 0) return failed("reading the configuration", code);
  interface_ = -1;
  for (int i = 0; i < config->bNumInterfaces; ++i)
    if (config->interface[i].num_altsetting >= 1) find_pipe(config->interface[i].altsetting[0]);
  libusb_free_config_descriptor(config);
  if (interface_ < 0) return Error{ErrorCode::kDevice, name_ + ": has no stream interface"};
  code = libusb_claim_interface(handle_, interface_);
  if (code == 0) return {};
  interface_ = -1;
  return failed("claiming the interface", code);
}

void LibusbBulk::find_pipe(const libusb_interface_descriptor& setting) {
  if (setting.bInterfaceClass != LIBUSB_CLASS_VENDOR_SPEC ||
      setting.bInterfaceSubClass != address_.subclass ||
      setting.bInterfaceProtocol != address_.protocol)
    return;
  for (int e = 0; e < setting.bNumEndpoints; ++e) {
    const auto& endpoint = setting.endpoint[e];
    const bool bulk =
        (endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK;
    if (!bulk || (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) == 0) continue;
    interface_ = setting.bInterfaceNumber;
    pipe_ = endpoint.bEndpointAddress;
  }
}

void LibusbBulk::close() {
  if (handle_ == nullptr) return;
  cancel();
  if (interface_ >= 0) (void)libusb_release_interface(handle_, interface_);
  interface_ = -1;
  libusb_close(std::exchange(handle_, nullptr));
}

Result<std::size_t> LibusbBulk::request(std::uint8_t request, std::uint16_t value,
                                        std::span<std::uint8_t> in) {
  if (handle_ == nullptr) return failed("a request", LIBUSB_ERROR_NO_DEVICE);
  const int got =
      libusb_control_transfer(handle_, in.empty() ? kToDevice : kFromDevice, request, value,
                              static_cast<std::uint16_t>(interface_), in.data(),
                              static_cast<std::uint16_t>(in.size()), kControlTimeout_ms);
  if (got < 0) return failed("a request", got);
  return static_cast<std::size_t>(got);
}

Result<void> LibusbBulk::submit() {
  if (handle_ == nullptr) return failed("submitting a transfer", LIBUSB_ERROR_NO_DEVICE);
  (void)libusb_clear_halt(handle_, pipe_);
  transfers_.begin();
  std::uint8_t* memory = memory_.data();
  for (libusb_transfer* transfer : transfers_.all()) {
    libusb_fill_bulk_transfer(transfer, handle_, pipe_, memory, kTransferBytes, on_transfer, this,
                              0);
    memory += kTransferBytes;
    if (const int code = transfers_.submit(transfer); code != 0) {
      cancel();
      return failed("submitting a transfer", code);
    }
  }
  return {};
}

void LibusbBulk::cancel() { transfers_.cancel(context_); }

BulkState LibusbBulk::pump(Duration timeout, const BulkSink& sink) {
  sink_ = &sink;
  const BulkState state = transfers_.pump(context_, timeout);
  sink_ = nullptr;
  return state;
}

/// Runs inside libusb_handle_events, on the thread that pumps.
void LIBUSB_CALL LibusbBulk::on_transfer(libusb_transfer* transfer) {
  auto& self = *static_cast<LibusbBulk*>(transfer->user_data);
  self.transfers_.returned(transfer, [&self](libusb_transfer* t) { self.give(t); });
}

void LibusbBulk::give(libusb_transfer* transfer) {
  if (sink_ != nullptr)
    (*sink_)({transfer->buffer, static_cast<std::size_t>(transfer->actual_length)});
}

}  // namespace

Result<std::unique_ptr<UsbBulk>> make_libusb_bulk(const BulkAddress& address, std::string name) {
  auto bulk = std::make_unique<LibusbBulk>(address, std::move(name));
  MIXRIG_TRY(bulk->init());
  return std::unique_ptr<UsbBulk>(std::move(bulk));
}

}  // namespace mixrig::device
