// SPDX-License-Identifier: Apache-2.0
// The scripted OpenNI2 camera of a test, and recordings of it by the library's own recorder.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <OniCAPI.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "tests/support/openni2/scripted_driver.h"
#include "tests/support/progress.h"

namespace mixrig::test {

/// Calls into the driver module that the library loads from the same file.
class ScriptedModule {
 public:
  explicit ScriptedModule(const char* path, const ScriptedCamera& camera)
      : module_(dlopen(path, RTLD_NOW)), camera_(camera) {
    EXPECT_NE(module_, nullptr) << dlerror();
    call<decltype(scripted_describe)>("scripted_describe")(&camera_);
  }
  void plug(bool in) { call<decltype(scripted_plug)>("scripted_plug")(in ? 1 : 0); }
  int streams() { return call<decltype(scripted_streams)>("scripted_streams")(); }
  bool registered() { return call<decltype(scripted_registered)>("scripted_registered")() != 0; }
  void expose(int frame, const std::vector<std::uint16_t>& depth,
              const std::vector<std::uint8_t>& rgb) {
    call<decltype(scripted_expose)>("scripted_expose")(frame, depth.data(), rgb.data());
  }
  const ScriptedCamera& camera() const { return camera_; }

 private:
  template <typename F>
  F* call(const char* name) {
    return reinterpret_cast<F*>(dlsym(module_, name));
  }
  void* module_;
  ScriptedCamera camera_;
};

/// Records depth and colour of the camera with the library's own recorder. The recorder begins with
/// a delay; the given picture is shown until it does. A recording therefore begins with one or
/// several copies of it, and one stream may have one copy more than the other.
class ScriptedRecording {
 public:
  ScriptedRecording(const std::string& file, ScriptedModule& module,
                    const std::vector<std::uint16_t>& depth, const std::vector<std::uint8_t>& rgb) {
    EXPECT_EQ(oniInitialize(ONI_API_VERSION), ONI_STATUS_OK);
    EXPECT_EQ(oniDeviceOpen("scripted", &device_), ONI_STATUS_OK);
    EXPECT_EQ(oniCreateRecorder(file.c_str(), &recorder_), ONI_STATUS_OK);
    for (const auto sensor : {ONI_SENSOR_DEPTH, ONI_SENSOR_COLOR}) {
      OniStreamHandle stream = nullptr;
      EXPECT_EQ(oniDeviceCreateStream(device_, sensor, &stream), ONI_STATUS_OK);
      EXPECT_EQ(oniRecorderAttachStream(recorder_, stream, FALSE), ONI_STATUS_OK);
      streams_.push_back(stream);
    }
    EXPECT_EQ(oniRecorderStart(recorder_), ONI_STATUS_OK);
    for (OniStreamHandle stream : streams_) EXPECT_EQ(oniStreamStart(stream), ONI_STATUS_OK);
    // The limit bounds memory: pictures that the recorder has not written yet wait there.
    constexpr int kMostShown = 200;
    auto shown = std::chrono::steady_clock::now();
    EXPECT_TRUE(comes_true([&] {
      if (const auto now = std::chrono::steady_clock::now(); frames_ < kMostShown && now >= shown) {
        module.expose(next(), depth, rgb);
        shown = now + std::chrono::milliseconds(10);
      }
      std::error_code none;
      const auto bytes = std::filesystem::file_size(file, none);
      return !none && bytes > rgb.size();
    })) << "the recorder does not begin";
  }
  /// Number of the frame that is shown next.
  int next() { return ++frames_; }
  ScriptedRecording(const ScriptedRecording&) = delete;
  ScriptedRecording& operator=(const ScriptedRecording&) = delete;
  /// Completes and closes the file.
  ~ScriptedRecording() {
    oniRecorderStop(recorder_);
    oniRecorderDestroy(&recorder_);
    for (OniStreamHandle stream : streams_) {
      oniStreamStop(stream);
      oniStreamDestroy(stream);
    }
    oniDeviceClose(device_);
    oniShutdown();
  }

 private:
  int frames_ = 0;
  OniDeviceHandle device_ = nullptr;
  OniRecorderHandle recorder_ = nullptr;
  std::vector<OniStreamHandle> streams_;
};

}  // namespace mixrig::test
