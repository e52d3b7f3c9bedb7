// SPDX-License-Identifier: Apache-2.0
// What a target of the interface means, and bodies as commands. Pure;
// docs/reference/page_openapi.yaml.
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
/// A part of the state, or all of it where `part` is empty.
struct GetState {
  std::string part;
};
struct GetPicture {
  View view = View::kComposite;
  bool stream = false;  ///< else one
};
/// By WebRTC: opens its socket.
struct WatchPicture {
  View view = View::kComposite;
};
struct OpenEvents {};
/// A model as body, up to kMostUpload bytes.
struct Upload {
  std::string name;
};
/// With a JSON body: command_of() says which command it is.
struct Change {
  Method method = Method::kPut;
  std::string kind;  ///< "objects", "lamps", "cameras", "scene", "record", "background", "sweep",
                     ///< "view", "freeze", "focus"
  std::string name;  ///< of an object or lamp; "start", "stop", "save", "learn", "scan",
                     ///< "cancel"
};

using Route =
    std::variant<Answer, GetFile, GetState, GetPicture, WatchPicture, OpenEvents, Upload, Change>;
using Action = std::variant<Command, output::RunOrder>;

inline constexpr std::size_t kMostBody = std::size_t{64} << 10;
inline constexpr std::size_t kMostUpload = std::size_t{64} << 20;
inline constexpr std::size_t kMostName = 64, kMostNotes = 4096;

/// An Answer where it is refused: 404, or 405 for another method.
Route route_of(Method method, std::string_view target);

/// The body of a change; an empty one is {}. Errors: kUsage, naming the key: no JSON object, deeper
/// than 8, an unknown key, a wrong type, a number out of its range, a text that is too long.
Result<Action> action_of(const Change& change, std::string_view body);

/// Whether it can be the name of an object, a lamp or a recording: 1 to kMostName bytes of UTF-8
/// without control characters.
bool is_name(std::string_view text);
/// Whether it can be the name of a folder too: letters, digits, ' ', '_', '-', '.', not first a
/// dot.
bool is_folder_name(std::string_view text);

}  // namespace mixrig::page
