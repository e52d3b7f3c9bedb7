// SPDX-License-Identifier: Apache-2.0
// Owns GStreamer pipelines and reports their errors in one line.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "hal/base/result.h"

namespace mixrig::take {

/// Starts GStreamer once; later calls do nothing. The first start of a user reads all plug-ins,
/// which takes up to a minute on a slow disk. Errors: kUnsupported.
Result<void> start_gstreamer();

/// An element of GStreamer, and the Debian package that has it.
struct GstNeed {
  const char *element, *package;
};
/// Checks that GStreamer has these elements. Errors: kUnsupported, naming the packages that are
/// missing for `what`.
Result<void> check_elements(const std::vector<GstNeed>& needs, const std::string& what);

struct GstUnref {
  void operator()(void* object) const { gst_object_unref(object); }
};
using GstElementPtr = std::unique_ptr<GstElement, GstUnref>;

/// Builds a pipeline from a fixed description; stops it and frees it at the end.
class Pipeline {
 public:
  /// Makes a pipeline. `name` names its output in errors. Errors: kUnsupported with GStreamer's
  /// words.
  static Result<Pipeline> launch(const std::string& description, std::string name);
  /// Makes a pipeline; `file` is set on the element named "file". Errors: kUnsupported if a plug-in
  /// is missing.
  static Result<Pipeline> create(const std::string& description, const std::filesystem::path& file);
  Pipeline(Pipeline&&) noexcept = default;
  Pipeline& operator=(Pipeline&& other) noexcept;
  ~Pipeline();

  GstElement* get() const { return pipeline_.get(); }
  GstElement* element(const char* name) const;
  /// Starts the pipeline. Errors: kIo with the pipeline's own message.
  Result<void> play();
  /// Stops the pipeline, drops what it holds and its messages, and starts it. Errors: those of
  /// play().
  Result<void> restart();
  /// Returns the last error that the pipeline posted, as "WHAT: WHY".
  Error error(ErrorCode code, const std::string& what) const;
  bool has_failed() const;
  /// Waits for a message. Errors: kFormat "cannot VERB FILE" after an error of the pipeline or ten
  /// seconds without a message.
  Result<void> wait_for(GstMessageType message, const char* verb) const;

 private:
  explicit Pipeline(GstElementPtr pipeline, std::string name)
      : pipeline_(std::move(pipeline)), name_(std::move(name)) {}
  GstElementPtr pipeline_;
  std::string name_;
};

}  // namespace mixrig::take
