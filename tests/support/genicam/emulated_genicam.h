// SPDX-License-Identifier: Apache-2.0
// A GigE Vision camera on the loopback interface: libaravis' own emulated camera with features of
// another one. Discovery broadcasts: run it in a network namespace of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/genicam/gvsp_sender.h"

typedef struct _ArvGvFakeCamera ArvGvFakeCamera;  // NOLINT(modernize-use-using): as libaravis
typedef struct _ArvBuffer ArvBuffer;              // NOLINT(modernize-use-using)

namespace mixrig::test {

/// What a camera description has beside the built-in one.
struct GenicamFeatures {
  std::vector<std::pair<std::string, std::uint32_t>> formats{};  ///< name, PFNC code
  std::string xml{};                                             ///< nodes
  int payload_bytes = 0;    ///< of a buffer, where it is not the picture alone
  bool sends_alone = true;  ///< false: pictures are sent by the test, whatever the trigger
  bool multipart = false;   ///< the camera says that its buffers can have several parts
  Size size{};              ///< of its sensor; empty: that of the built-in camera
};

// Nodes of a description. A register lies in the camera's memory, in network order.
std::string genicam_number(const std::string& name, const std::string& value);
/// An enumeration of one entry.
std::string genicam_choice(const std::string& name, const std::string& entry);
std::string genicam_register(const std::string& kind, const std::string& name,
                             std::uint32_t address, const std::string& more = {});
/// A ComponentSelector of Range, Intensity and Confidence; their ComponentEnable are registers of
/// four bytes from kGenicamComponentsAt on.
std::string genicam_components();
inline constexpr std::uint32_t kGenicamComponentsAt = 0x8000;

/// LUCID Helios2, by its technical manual: 0.25 mm a step, invalid points are 65535.
GenicamFeatures helios2_features(double focal_px = 512.5, double u_px = 319.5, double v_px = 239.5);

class EmulatedGenicam {
 public:
  using Fill = void (*)(ArvBuffer*, void*, std::uint32_t, std::uint32_t, std::uint32_t);

  /// `fill` draws the pictures that the camera sends by itself; none: libaravis' ramp. Each camera
  /// needs an address of its own.
  EmulatedGenicam(const std::string& serial, const GenicamFeatures& features, Fill fill = nullptr,
                  const std::string& address = "127.0.0.1");
  ~EmulatedGenicam();
  EmulatedGenicam(const EmulatedGenicam&) = delete;
  EmulatedGenicam& operator=(const EmulatedGenicam&) = delete;

  bool running() const;
  /// The host has started the acquisition.
  bool acquiring() const;
  /// Where the host that acquires wants the stream.
  GvspHost host() const;
  /// A register, in this machine's order.
  std::uint32_t word(std::uint32_t address) const;
  void set_word(std::uint32_t address, std::uint32_t value) const;
  std::uint32_t memory(std::uint32_t address) const;  ///< as it lies there

 private:
  std::string description_;
  ArvGvFakeCamera* camera_;
};

}  // namespace mixrig::test
