// SPDX-License-Identifier: Apache-2.0
// Runs GStreamer pipelines.
#include "host/capture/take/streams/gst_pipeline.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "hal/base/log.h"

namespace mixrig::take {
namespace {

constexpr int kMostWait_s = 10;

/// GStreamer's text of an error, with the system's reason where the element gives one: the last
/// line of its details.
std::string why_of(GstMessage* message) {
  GError* error = nullptr;
  gchar* details = nullptr;
  gst_message_parse_error(message, &error, &details);
  std::string why = error != nullptr ? error->message : "unknown";
  const std::string_view all = details != nullptr ? details : "";
  const std::string_view last = all.substr(all.rfind('\n') + 1);
  if (error != nullptr && error->domain == GST_RESOURCE_ERROR && all.find('\n') != all.npos &&
      !last.empty())
    why += " (" + std::string(last) + ")";
  g_clear_error(&error);
  g_free(details);
  return why;
}

/// Whether the error is one of a file or a device.
bool is_of_resource(GstMessage* message) {
  GError* error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  const bool is = error != nullptr && error->domain == GST_RESOURCE_ERROR;
  g_clear_error(&error);
  return is;
}

/// Whether GStreamer has this user's list of plug-ins: $GST_REGISTRY, else a file in the cache.
bool has_plugin_list() {
  std::error_code ignored;
  for (const char* name : {"GST_REGISTRY_1_0", "GST_REGISTRY"})
    if (const char* const file = std::getenv(name)) return std::filesystem::exists(file, ignored);
  const std::filesystem::path folder =
      std::filesystem::path(g_get_user_cache_dir()) / "gstreamer-1.0";
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".bin") return true;
  return false;
}

}  // namespace

Result<void> start_gstreamer() {
  if (gst_is_initialized() == 0 && !has_plugin_list())
    log_warning("take", "GStreamer lists its plug-ins, once for this user: up to a minute");
  GError* error = nullptr;
  if (gst_init_check(nullptr, nullptr, &error) != 0) return {};
  const std::string why = error != nullptr ? error->message : "unknown";
  g_clear_error(&error);
  return Error{ErrorCode::kUnsupported, "cannot start GStreamer: " + why};
}

Result<void> check_elements(const std::vector<GstNeed>& needs, const std::string& what) {
  MIXRIG_TRY(start_gstreamer());
  std::vector<std::string> packages;
  std::string elements;
  for (const GstNeed& need : needs) {
    GstElementFactory* const found = gst_element_factory_find(need.element);
    if (found != nullptr) {
      gst_object_unref(found);
      continue;
    }
    elements += (elements.empty() ? "" : ", ") + std::string(need.element);
    if (std::find(packages.begin(), packages.end(), need.package) == packages.end())
      packages.emplace_back(need.package);
  }
  if (packages.empty()) return {};
  std::string install;
  for (const std::string& package : packages) install += (install.empty() ? "" : " and ") + package;
  return Error{ErrorCode::kUnsupported,
               "cannot write " + what + ": GStreamer has no " + elements + ": install " + install};
}

Result<Pipeline> Pipeline::launch(const std::string& description, std::string name) {
  MIXRIG_TRY(start_gstreamer());
  GError* error = nullptr;
  GstElementPtr pipeline(
      gst_parse_launch_full(description.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error));
  if (pipeline) return Pipeline(std::move(pipeline), std::move(name));
  const std::string why = error != nullptr ? error->message : "unknown";
  g_clear_error(&error);
  return Error{ErrorCode::kUnsupported, why};
}

Result<Pipeline> Pipeline::create(const std::string& description,
                                  const std::filesystem::path& file) {
  auto result = launch(description, file.string());
  if (!result)
    return Error{result.error().code,
                 "cannot use Matroska for '" + file.string() + "': " + result.error().context +
                     ": install gstreamer1.0-plugins-good and gstreamer1.0-libav"};
  const GstElementPtr end(result->element("file"));
  g_object_set(end.get(), "location", file.c_str(), nullptr);
  return result;
}

Pipeline& Pipeline::operator=(Pipeline&& other) noexcept {
  std::swap(pipeline_, other.pipeline_);
  std::swap(name_, other.name_);
  return *this;
}

Pipeline::~Pipeline() {
  if (pipeline_) gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
}

GstElement* Pipeline::element(const char* name) const {
  return gst_bin_get_by_name(GST_BIN(pipeline_.get()), name);
}

Result<void> Pipeline::play() {
  if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE)
    return {};
  return error(ErrorCode::kIo, "cannot open '" + name_ + "'");
}

Result<void> Pipeline::restart() {
  gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
  return play();  // its messages went with the state
}

Error Pipeline::error(ErrorCode code, const std::string& what) const {
  GstBus* bus = gst_element_get_bus(pipeline_.get());
  std::string why;
  // An element that cannot write says so; the source after it, that the stream has ended.
  for (bool names_cause = false; !names_cause;) {
    GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    if (message == nullptr) break;
    names_cause = is_of_resource(message);
    if (names_cause || why.empty()) why = why_of(message);
    gst_message_unref(message);
  }
  gst_object_unref(bus);
  return Error{code, why.empty() ? what : what + ": " + why};
}

bool Pipeline::has_failed() const {
  GstBus* bus = gst_element_get_bus(pipeline_.get());
  GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  // The message stays on the bus, where error() reads it.
  if (message != nullptr) gst_bus_post(bus, message);
  gst_object_unref(bus);
  return message != nullptr;
}

Result<void> Pipeline::wait_for(GstMessageType wanted, const char* verb) const {
  GstBus* bus = gst_element_get_bus(pipeline_.get());
  const auto either = static_cast<GstMessageType>(GST_MESSAGE_ERROR | wanted);
  GstMessage* message = gst_bus_timed_pop_filtered(bus, kMostWait_s * GST_SECOND, either);
  const bool came = message != nullptr && GST_MESSAGE_TYPE(message) == wanted;
  if (message != nullptr && !came) gst_bus_post(bus, message);
  if (came) gst_message_unref(message);
  gst_object_unref(bus);
  if (came) return {};
  const std::string what = std::string("cannot ") + verb + " '" + name_ + "'";
  if (message != nullptr) return error(ErrorCode::kFormat, what);
  return Error{ErrorCode::kFormat, what + ": GStreamer is not done after " +
                                       std::to_string(kMostWait_s) +
                                       " s: the disk or the machine is too slow: try again"};
}

}  // namespace mixrig::take
