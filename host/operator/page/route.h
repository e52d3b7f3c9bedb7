// SPDX-License-Identifier: Apache-2.0
// Parses targets of the interface, and bodies as commands. Pure; docs/reference/page_openapi.yaml.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "hal/base/result.h"
#include "host/operator/page/operator.h"
#include "host/operator/page/request.h"
#include "host/output/sink/run_orders.h"
#include "host/output/sink/views.h"

namespace mixrig::page {

using output::View;
using output::view_named;

struct GetFile {
  std::string name;  ///< "index.html"
};
/// Gets a part of the state, or all of it where `part` is empty.
struct GetState {
  std::string part;
};
struct GetPicture {
  View view = View::kComposite;
  bool stream = false;  ///< false: a single picture
};
/// Gets picture `frame`, from 1, of a recording.
struct GetTakePicture {
  std::string take;
  int frame = 1;
};
/// Opens the WebRTC socket of a view.
struct WatchPicture {
  View view = View::kComposite;
};
struct OpenEvents {};
/// Uploads a model as body, up to kMostUpload bytes.
struct Upload {
  std::string name;
};
/// A change with a JSON body, from which action_of() makes the command.
struct Change {
  Method method = Method::kPut;
  std::string kind;  ///< "objects", "lamps", "cameras", "scene", "record", "background", "sweep",
                     ///< "view", "freeze", "focus", "copy", "presets", "recall", "takes"
  std::string name;  ///< an object's or lamp's; "start", "stop", "save",
                     ///< "discard", "undo", "redo", "learn", "scan", "cancel"
};

using Route = std::variant<Answer, GetFile, GetState, GetPicture, GetTakePicture, WatchPicture,
                           OpenEvents, Upload, Change>;
using Action = std::variant<Command, output::RunOrder>;

inline constexpr std::size_t kMostBody = std::size_t{64} << 10;
inline constexpr std::size_t kMostUpload = std::size_t{64} << 20;
inline constexpr std::size_t kMostName = 64, kMostNotes = 4096;

/// Route of a target; an Answer where it is refused: 404, or 405 for another method.
Route route_of(Method method, std::string_view target);

/// Action of a change and its body; an empty body is {}. Errors: kUsage, naming the key: not a JSON
/// object, deeper than 8, an unknown key, a wrong type, a number out of its range, a text that is
/// too long.
Result<Action> action_of(const Change& change, std::string_view body);

/// Whether it can be the name of an object, a lamp or a recording: 1 to kMostName bytes of UTF-8
/// without control characters.
bool is_name(std::string_view text);
/// Whether it is a name that can also be a folder's: letters, digits, ' ', '_', '-', '.', not
/// beginning with a dot.
bool is_folder_name(std::string_view text);

}  // namespace mixrig::page
