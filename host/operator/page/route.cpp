// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/route.h"

#include <algorithm>
#include <charconv>

#include <nlohmann/json.hpp>

#include "host/operator/page/json_body.h"
#include "host/operator/page/state_json.h"

namespace mixrig::page {
namespace {

using Parts = std::vector<std::string>;

Answer no_such() { return refusal(404, "there is nothing under this address: see /api/v1/state"); }
Answer wrong_method(std::string_view allowed) {
  Answer answer = refusal(405, "this method is not served here: use " + std::string(allowed));
  answer.headers.emplace_back("Allow", allowed);
  return answer;
}

Route file_route(Method method, const Parts& parts) {
  if (method != Method::kGet) return wrong_method("GET");
  if (parts.empty()) return GetFile{"index.html"};
  return parts.size() == 1 ? Route(GetFile{parts[0]}) : Route(no_such());
}

/// "composite.mjpeg", "key.jpg", "composite.webrtc".
Route picture_route(Method method, const std::string& file) {
  const std::size_t dot = file.rfind('.');
  const auto view = view_named(file.substr(0, dot));
  const std::string kind = dot == std::string::npos ? "" : file.substr(dot + 1);
  if (!view || (kind != "mjpeg" && kind != "jpg" && kind != "webrtc")) return no_such();
  if (method != Method::kGet) return wrong_method("GET");
  if (kind == "webrtc") return WatchPicture{*view};
  return GetPicture{*view, kind == "mjpeg"};
}

/// /cameras, /cameras/NAME.
Route camera_route(Method method, const Parts& rest) {
  if (rest.empty())
    return method == Method::kGet ? Route(GetState{"cameras"}) : Route(wrong_method("GET"));
  if (rest.size() != 1 || !is_name(rest[0])) return no_such();
  if (method != Method::kPut) return wrong_method("PUT");
  return Change{method, "cameras", rest[0]};
}

/// /presets, /presets/NAME, /presets/NAME/recall.
Route preset_route(Method method, const Parts& rest) {
  if (rest.empty())
    return method == Method::kGet ? Route(GetState{"presets"}) : Route(wrong_method("GET"));
  if (!is_folder_name(rest[0])) return no_such();
  if (rest.size() == 2 && rest[1] == "recall")
    return method == Method::kPost ? Route(Change{method, "recall", rest[0]})
                                   : Route(wrong_method("POST"));
  if (rest.size() != 1) return no_such();
  if (method == Method::kPut || method == Method::kDelete)
    return Change{method, "presets", rest[0]};
  return wrong_method("PUT, DELETE");
}

/// "17.jpg" as 17; nullopt for anything else.
std::optional<int> frame_of(std::string_view file) {
  int frame = 0;
  const char* end = file.data() + file.size();
  const auto [rest, fault] = std::from_chars(file.data(), end, frame);
  if (fault != std::errc{} || frame < 1 || std::string_view(rest, end) != ".jpg")
    return std::nullopt;
  return frame;
}

/// /takes, /takes/NAME, /takes/NAME/FRAME.jpg.
Route take_route(Method method, const Parts& rest) {
  if (rest.empty())
    return method == Method::kGet ? Route(GetState{"takes"}) : Route(wrong_method("GET"));
  if (!is_folder_name(rest[0])) return no_such();
  if (rest.size() == 2 && frame_of(rest[1]))
    return method == Method::kGet ? Route(GetTakePicture{rest[0], *frame_of(rest[1])})
                                  : Route(wrong_method("GET"));
  if (rest.size() != 1) return no_such();
  if (method != Method::kPut) return wrong_method("PUT");
  return Change{method, "takes", rest[0]};
}

/// /objects, /objects/NAME, /objects/NAME/copy, /lamps, /lamps/NAME; a lamp is added by POST
/// /lamps, an object by POST /objects/NAME.
Route thing_route(Method method, const std::string& kind, const Parts& rest) {
  const bool lamps = kind == "lamps";
  if (rest.empty()) {
    if (method == Method::kGet) return GetState{kind};
    if (lamps && method == Method::kPost) return Change{method, kind, ""};
    return wrong_method(lamps ? "GET, POST" : "GET");
  }
  if (!is_name(rest[0])) return no_such();
  if (!lamps && rest.size() == 2 && rest[1] == "copy")
    return method == Method::kPost ? Route(Change{method, "copy", rest[0]})
                                   : Route(wrong_method("POST"));
  if (rest.size() != 1) return no_such();
  if (!lamps && method == Method::kPost) return Upload{rest[0]};
  if (method == Method::kPut || method == Method::kDelete) return Change{method, kind, rest[0]};
  return wrong_method(lamps ? "PUT, DELETE" : "PUT, POST, DELETE");
}

Route post_route(Method method, const std::string& kind, const std::string& verb) {
  if (method != Method::kPost) return wrong_method("POST");
  return Change{method, kind, verb};
}

Route api_route(Method method, const Parts& parts) {
  const std::string& kind = parts[2];
  const Parts rest(parts.begin() + 3, parts.end());
  if (kind == "objects" || kind == "lamps") return thing_route(method, kind, rest);
  if (kind == "cameras") return camera_route(method, rest);
  if (kind == "presets") return preset_route(method, rest);
  if (kind == "takes") return take_route(method, rest);
  if (kind == "picture" && rest.size() == 1) return picture_route(method, rest[0]);
  if (kind == "event" && rest.size() == 1 && rest[0] == "websocket")
    return method == Method::kGet ? Route(OpenEvents{}) : Route(wrong_method("GET"));
  if ((kind == "view" || kind == "freeze" || kind == "focus") && rest.empty()) {
    if (method == Method::kPut) return Change{method, kind, ""};
    return method == Method::kGet ? Route(GetState{kind}) : Route(wrong_method("GET, PUT"));
  }
  if (kind == "record" && rest.size() == 1 && (rest[0] == "start" || rest[0] == "stop"))
    return post_route(method, kind, rest[0]);
  if (kind == "scene" && rest.size() == 1 &&
      (rest[0] == "save" || rest[0] == "discard" || rest[0] == "undo" || rest[0] == "redo"))
    return post_route(method, kind, rest[0]);
  if (kind == "background" && rest.size() == 1 &&
      (rest[0] == "learn" || rest[0] == "scan" || rest[0] == "cancel"))
    return post_route(method, kind, rest[0]);
  if (kind == "sweep" && rest.size() == 1 && (rest[0] == "start" || rest[0] == "cancel"))
    return post_route(method, kind, rest[0]);
  if (!rest.empty() || !(kind == "state" || is_part(kind))) return no_such();
  if (method != Method::kGet) return wrong_method("GET");
  return GetState{kind == "state" ? "" : kind};
}

}  // namespace

bool is_name(std::string_view text) {
  if (text.empty() || text.size() > kMostName || !is_utf8(text)) return false;
  return std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7F;
  });
}

bool is_folder_name(std::string_view text) {
  const auto is_good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == ' ' ||
           c == '_' || c == '-' || c == '.';
  };
  return !text.empty() && text.size() <= kMostName && text.front() != '.' && text.front() != ' ' &&
         text.back() != ' ' && std::all_of(text.begin(), text.end(), is_good);
}

Route route_of(Method method, std::string_view target) {
  const auto parts = path_of(target);
  if (!parts) return no_such();
  if (parts->empty() || (*parts)[0] != "api") return file_route(method, *parts);
  if (parts->size() < 3 || (*parts)[1] != "v1") return no_such();
  return api_route(method, *parts);
}

}  // namespace mixrig::page
