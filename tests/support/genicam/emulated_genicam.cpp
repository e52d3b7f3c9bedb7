// SPDX-License-Identifier: Apache-2.0
#include "tests/support/genicam/emulated_genicam.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <arv.h>
#include <unistd.h>

#include "hal/wire/camera/genicam_buffer.h"

namespace mixrig::test {
namespace {

// Registers of libaravis' emulated camera and of the GigE Vision standard.
constexpr std::uint32_t kWidth = 0x100, kHeight = 0x104, kSensorHeight = 0x118,
                        kSensorWidth = 0x11C, kAcquisition = 0x124, kTriggerMode = 0x300,
                        kTriggerSource = 0x304, kStreamPort = 0xD00, kPacketSize = 0xD04,
                        kStreamAddress = 0xD18, kStreamCapabilities = 0xD20;
constexpr std::uint32_t kMultipartCapability = 1U << 6;  // bit 25, counted from the left

void replace(std::string& text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  if (at == std::string::npos) throw std::runtime_error("libaravis' description has no " + what);
  text.replace(at, what.size(), with);
}

/// Writes the built-in camera description with the features added to a file.
std::string description(const GenicamFeatures& features) {
  ArvGvFakeCamera* plain = arv_gv_fake_camera_new("127.0.0.1", "PLAIN");
  size_t size = 0;
  const char* xml =
      arv_fake_camera_get_genicam_xml(arv_gv_fake_camera_get_fake_camera(plain), &size);
  std::string text(xml, size);
  g_object_unref(plain);
  const std::string formats = "<Enumeration Name=\"PixelFormat\"";
  for (const auto& [name, code] : features.formats)
    text.insert(text.find("<EnumEntry", text.find(formats)),
                "<EnumEntry Name=\"" + name + "\" NameSpace=\"Standard\"><Value>" +
                    std::to_string(code) + "</Value></EnumEntry>\n");
  std::string more = features.xml;
  if (features.payload_bytes > 0) {
    replace(text, "Name=\"PayloadSize\"", "Name=\"PictureSize\"");
    more += "<Integer Name=\"PayloadSize\"><Value>" + std::to_string(features.payload_bytes) +
            "</Value></Integer>\n";
  }
  // The host then sets a trigger register that the emulated camera ignores.
  if (!features.sends_alone) replace(text, "<Address>0x300</Address>", "<Address>0x3300</Address>");
  text.insert(text.find(formats), more);
  static int count = 0;
  const auto path =
      std::filesystem::temp_directory_path() /
      ("mixrig_genicam_" + std::to_string(::getpid()) + "_" + std::to_string(++count) + ".xml");
  std::ofstream(path) << text;
  return path;
}

}  // namespace

std::string genicam_number(const std::string& name, const std::string& value) {
  return "<Float Name=\"" + name + "\"><Value>" + value + "</Value></Float>\n";
}

std::string genicam_choice(const std::string& name, const std::string& entry) {
  return "<Enumeration Name=\"" + name + "\"><EnumEntry Name=\"" + entry +
         "\"><Value>0</Value></EnumEntry><Value>0</Value></Enumeration>\n";
}

std::string genicam_register(const std::string& kind, const std::string& name,
                             std::uint32_t address, const std::string& more) {
  return "<" + kind + " Name=\"" + name + "\"><Address>" + std::to_string(address) + "</Address>" +
         more + "<Length>4</Length><AccessMode>RW</AccessMode><pPort>Device</pPort>" +
         "<Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></" + kind + ">\n";
}

std::string genicam_components() {
  return "<Enumeration Name=\"ComponentSelector\">"
         "<EnumEntry Name=\"Range\"><Value>0</Value></EnumEntry>"
         "<EnumEntry Name=\"Intensity\"><Value>1</Value></EnumEntry>"
         "<EnumEntry Name=\"Confidence\"><Value>2</Value></EnumEntry>"
         "<pValue>Component</pValue></Enumeration>\n"
         "<Integer Name=\"Component\"><Value>2</Value></Integer>\n"
         "<Boolean Name=\"ComponentEnable\"><pValue>ComponentRegister</pValue></Boolean>\n" +
         genicam_register("IntReg", "ComponentRegister", kGenicamComponentsAt,
                          "<pIndex Offset=\"4\">Component</pIndex>");
}

GenicamFeatures helios2_features(double focal_px, double u_px, double v_px) {
  return {.formats = {{"Coord3D_C16", device::pfnc::kCoord3dC16},
                      {"Coord3D_ABCY16", device::pfnc::kCoord3dAbcy16}},
          .xml = genicam_number("Scan3dCoordinateScale", "0.25") +
                 genicam_number("Scan3dCoordinateOffset", "0.0") +
                 "<Boolean Name=\"Scan3dInvalidDataFlag\"><Value>1</Value></Boolean>\n" +
                 genicam_number("Scan3dInvalidDataValue", "65535.0") +
                 genicam_choice("Scan3dDistanceUnit", "Millimeter") +
                 genicam_choice("Scan3dOutputMode", "CalibratedABC_Grid") +
                 genicam_choice("Scan3dCoordinateSystem", "Cartesian") +
                 genicam_choice("Scan3dCoordinateSelector", "CoordinateC") +
                 genicam_number("Scan3dFocalLength", std::to_string(focal_px)) +
                 genicam_number("Scan3dPrincipalPointU", std::to_string(u_px)) +
                 genicam_number("Scan3dPrincipalPointV", std::to_string(v_px))};
}

EmulatedGenicam::EmulatedGenicam(const std::string& serial, const GenicamFeatures& features,
                                 Fill fill, const std::string& address)
    : description_(description(features)),
      camera_(arv_gv_fake_camera_new_full(address.c_str(), serial.c_str(), description_.c_str())) {
  if (fill != nullptr)
    arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera_), fill, nullptr);
  if (!features.sends_alone) set_word(kTriggerMode, 1), set_word(kTriggerSource, 0);
  if (features.multipart) set_word(kStreamCapabilities, kMultipartCapability);
  if (features.size.empty()) return;
  const auto width = static_cast<std::uint32_t>(features.size.width),
             height = static_cast<std::uint32_t>(features.size.height);
  set_word(kSensorWidth, width), set_word(kSensorHeight, height);
  set_word(kWidth, width), set_word(kHeight, height);
}

EmulatedGenicam::~EmulatedGenicam() {
  g_object_unref(camera_);
  std::filesystem::remove(description_);
}

bool EmulatedGenicam::running() const { return arv_gv_fake_camera_is_running(camera_); }

bool EmulatedGenicam::acquiring() const {
  return word(kAcquisition) != 0 && word(kStreamPort) != 0;
}

GvspHost EmulatedGenicam::host() const {
  return {word(kStreamAddress), static_cast<std::uint16_t>(word(kStreamPort)),
          word(kPacketSize) & 0xFFFF};
}

std::uint32_t EmulatedGenicam::word(std::uint32_t address) const {
  guint32 value = 0;
  arv_fake_camera_read_register(arv_gv_fake_camera_get_fake_camera(camera_), address, &value);
  return value;
}

void EmulatedGenicam::set_word(std::uint32_t address, std::uint32_t value) const {
  arv_fake_camera_write_register(arv_gv_fake_camera_get_fake_camera(camera_), address, value);
}

std::uint32_t EmulatedGenicam::memory(std::uint32_t address) const {
  std::uint32_t value = 0;
  arv_fake_camera_read_memory(arv_gv_fake_camera_get_fake_camera(camera_), address, sizeof value,
                              &value);
  return value;
}

}  // namespace mixrig::test
