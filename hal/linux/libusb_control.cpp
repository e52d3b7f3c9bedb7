// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/libusb_control.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include <libusb.h>

namespace mixrig::device {

namespace {

constexpr unsigned kTimeoutMs = 5000;
constexpr std::uint8_t kDfuClass = 0xFE, kDfuSubclass = 0x01, kDfuFunctional = 0x21;
constexpr std::uint8_t kToInterface = 0x21, kFromInterface = 0xA1;
constexpr std::size_t kMaxTransfer = 4096;

Error usb_error(ErrorCode code, const std::string& what, int status) {
  return Error{code, what + " (" + libusb_error_name(status) + ")"};
}

struct Session {
  libusb_context* context = nullptr;
  libusb_device_handle* handle = nullptr;
  int claimed = -1;
  Session() = default;
  Session(Session&& other) noexcept
      : context(std::exchange(other.context, nullptr)),
        handle(std::exchange(other.handle, nullptr)),
        claimed(std::exchange(other.claimed, -1)) {}
  Session& operator=(Session&&) = delete;
  ~Session() {
    if (claimed >= 0) libusb_release_interface(handle, claimed);
    if (handle != nullptr) libusb_close(handle);
    if (context != nullptr) libusb_exit(context);
  }
};

class LibusbControl final : public UsbControl {
 public:
  LibusbControl(Session session, DfuInterface dfu)
      : session_(std::move(session)), dfu_(std::move(dfu)) {}

  const DfuInterface& dfu() const override { return dfu_; }

  Result<void> send(std::uint8_t request, std::uint16_t value,
                    std::span<const std::uint8_t> data) override {
    auto* bytes = const_cast<std::uint8_t*>(data.data());  // libusb only reads it
    const int n = transfer(kToInterface, request, value, bytes, data.size());
    if (n == static_cast<int>(data.size())) return {};
    return usb_error(ErrorCode::kDevice, "USB bootloader refused a request", n);
  }
  Result<std::size_t> receive(std::uint8_t request, std::uint16_t value,
                              std::span<std::uint8_t> out) override {
    const int n = transfer(kFromInterface, request, value, out.data(), out.size());
    if (n >= 0) return static_cast<std::size_t>(n);
    return usb_error(ErrorCode::kDevice, "USB bootloader does not answer", n);
  }

 private:
  int transfer(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint8_t* data,
               std::size_t size) {
    return libusb_control_transfer(session_.handle, type, request, value, dfu_.number, data,
                                   static_cast<std::uint16_t>(size), kTimeoutMs);
  }

  Session session_;
  DfuInterface dfu_;
};

struct UsbId {
  std::uint16_t vendor = 0, product = 0;
};

Result<UsbId> parse_id(const std::string& id) {
  UsbId out;
  const char* end = id.data() + id.size();
  const auto vendor = std::from_chars(id.data(), end, out.vendor, 16);
  if (vendor.ec == std::errc{} && vendor.ptr != end && *vendor.ptr == ':') {
    const auto product = std::from_chars(vendor.ptr + 1, end, out.product, 16);
    if (product.ec == std::errc{} && product.ptr == end) return out;
  }
  return Error{ErrorCode::kUsage, "--usb " + id + ": give VID:PID in hex, as 0483:df11"};
}

Result<void> open_only_one(Session& session, UsbId id, const std::string& name) {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(session.context, &list);
  int found = 0, status = 0;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    if (descriptor.idVendor != id.vendor || descriptor.idProduct != id.product) continue;
    if (++found == 1) status = libusb_open(list[i], &session.handle);
  }
  if (count >= 0) libusb_free_device_list(list, 1);
  if (found == 0) {
    return Error{ErrorCode::kNotFound,
                 "no USB device " + name + ": hold BOOT0 high, press reset, and try again"};
  }
  if (found > 1) {
    return Error{ErrorCode::kDevice, "more than one USB device " + name + ": unplug all but one"};
  }
  if (status == 0) return {};
  return usb_error(ErrorCode::kIo,
                   "cannot open USB device " + name +
                       ": install 70-mixrig.rules in /etc/udev/rules.d, or run as root",
                   status);
}

std::size_t transfer_size(const libusb_interface_descriptor& setting) {
  const std::span<const std::uint8_t> extra(setting.extra,
                                            static_cast<std::size_t>(setting.extra_length));
  for (std::size_t at = 0; at + 2 <= extra.size() && extra[at] >= 2; at += extra[at]) {
    if (extra[at + 1] == kDfuFunctional && extra[at] >= 7 && at + 7 <= extra.size()) {
      return static_cast<std::size_t>(extra[at + 5] | extra[at + 6] << 8);
    }
  }
  return 0;
}

/// Claims the alternate setting whose name describes the flash that programs run from.
Result<DfuInterface> claim_flash(Session& session, const std::string& name) {
  libusb_config_descriptor* config = nullptr;
  const int status =
      libusb_get_active_config_descriptor(libusb_get_device(session.handle), &config);
  if (status != 0)
    return usb_error(ErrorCode::kDevice, "cannot read descriptors of " + name, status);
  std::optional<DfuInterface> found;
  int alternate = 0;
  for (int i = 0; i < config->bNumInterfaces && !found; ++i) {
    for (int a = 0; a < config->interface[i].num_altsetting && !found; ++a) {
      const libusb_interface_descriptor& setting = config->interface[i].altsetting[a];
      if (setting.bInterfaceClass != kDfuClass || setting.bInterfaceSubClass != kDfuSubclass) {
        continue;
      }
      std::array<unsigned char, 256> text{};
      const int n = libusb_get_string_descriptor_ascii(session.handle, setting.iInterface,
                                                       text.data(), static_cast<int>(text.size()));
      const std::string layout(text.begin(), text.begin() + std::max(n, 0));
      if (layout.find("/0x08000000/") == std::string::npos) continue;
      found = DfuInterface{setting.bInterfaceNumber, std::min(transfer_size(setting), kMaxTransfer),
                           layout};
      alternate = setting.bAlternateSetting;
    }
  }
  libusb_free_config_descriptor(config);
  if (!found) {
    return Error{ErrorCode::kDevice,
                 "USB device " + name + " has no DfuSe interface to internal flash: wrong device?"};
  }
  const int claimed = libusb_claim_interface(session.handle, found->number);
  if (claimed != 0) {
    return usb_error(ErrorCode::kIo, "cannot claim USB device " + name + ": in use?", claimed);
  }
  session.claimed = found->number;
  libusb_set_interface_alt_setting(session.handle, found->number, alternate);
  return *std::move(found);
}

}  // namespace

Result<std::unique_ptr<UsbControl>> open_dfu_device(const std::string& id) {
  MIXRIG_ASSIGN(const UsbId parsed, parse_id(id));
  Session session;
  const int status = libusb_init(&session.context);
  if (status != 0) return usb_error(ErrorCode::kIo, "cannot start libusb", status);
  MIXRIG_TRY(open_only_one(session, parsed, id));
  MIXRIG_ASSIGN(DfuInterface dfu, claim_flash(session, id));
  return std::unique_ptr<UsbControl>(
      std::make_unique<LibusbControl>(std::move(session), std::move(dfu)));
}

}  // namespace mixrig::device
