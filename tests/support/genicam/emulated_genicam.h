// SPDX-License-Identifier: Apache-2.0
// A GigE Vision camera on the loopback interface: libaravis' emulated camera with the features of
// another one. Its discovery uses broadcasts, so run it in a network namespace of its own.
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

/// Additions to the description of the built-in camera.
struct GenicamFeatures {
  std::vector<std::pair<std::string, std::uint32_t>> formats{};  ///< name and PFNC code
  std::string xml{};                                             ///< nodes as XML
  int payload_bytes = 0;    ///< size of a buffer; 0: that of the picture
  bool sends_alone = true;  ///< false: pictures are sent by the test, whatever the trigger
  bool multipart = false;   ///< the camera says that its buffers can have several parts
  Size size{};              ///< size of the sensor; empty: the built-in camera's
};

// Each returns a node of the description as XML. A register lies in the camera's memory, in network
// order.
std::string genicam_number(const std::string& name, const std::string& value);
/// An enumeration with one entry.
std::string genicam_choice(const std::string& name, const std::string& entry);
std::string genicam_register(const std::string& kind, const std::string& name,
                             std::uint32_t address, const std::string& more = {});
/// A ComponentSelector of Range, Intensity and Confidence; their ComponentEnable are registers of
/// four bytes from kGenicamComponentsAt on.
std::string genicam_components();
inline constexpr std::uint32_t kGenicamComponentsAt = 0x8000;

/// Features of a LUCID Helios2 by its technical manual: steps of 0.25 mm, invalid points are 65535.
GenicamFeatures helios2_features(double focal_px = 512.5, double u_px = 319.5, double v_px = 239.5);

class EmulatedGenicam {
 public:
  using Fill = void (*)(ArvBuffer*, void*, std::uint32_t, std::uint32_t, std::uint32_t);

  /// `fill` draws the pictures that the camera sends by itself; null: libaravis' ramp. Each camera
  /// needs its own address.
  EmulatedGenicam(const std::string& serial, const GenicamFeatures& features, Fill fill = nullptr,
                  const std::string& address = "127.0.0.1");
  ~EmulatedGenicam();
  EmulatedGenicam(const EmulatedGenicam&) = delete;
  EmulatedGenicam& operator=(const EmulatedGenicam&) = delete;

  bool running() const;
  /// Whether the host has started the acquisition.
  bool acquiring() const;
  /// Address and port to which the acquiring host wants the stream.
  GvspHost host() const;
  /// Value of a register, in this machine's byte order.
  std::uint32_t word(std::uint32_t address) const;
  void set_word(std::uint32_t address, std::uint32_t value) const;
  std::uint32_t memory(std::uint32_t address) const;  ///< word in the byte order of the memory

 private:
  std::string description_;
  ArvGvFakeCamera* camera_;
};

}  // namespace mixrig::test
