// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/request.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include <nlohmann/json.hpp>
#include <sys/random.h>

namespace mixrig::page {
namespace {

constexpr std::string_view kCookie = "mixrig_token=";
constexpr std::size_t kMostTarget = 512;

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// "localhost" of "localhost:8437", "[::1]" of "[::1]:8437"; empty where more follows than a port.
std::string_view name_of(std::string_view host) {
  const std::size_t bracket = host.find(']');
  const std::size_t end = host.front() == '[' && bracket != std::string_view::npos
                              ? bracket + 1
                              : std::min(host.find(':'), host.size());
  const std::string_view rest = host.substr(end);
  if (!rest.empty() &&
      (rest.front() != ':' || rest.find_first_not_of("0123456789", 1) != std::string_view::npos))
    return {};
  return host.substr(0, end);
}

bool is_loopback_name(std::string_view host) {
  const std::string_view name = name_of(host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The value of our cookie among "a=b; mixrig_token=...".
std::string_view token_of_cookie(std::string_view cookie) {
  while (!cookie.empty()) {
    const std::size_t end = std::min(cookie.find(';'), cookie.size());
    const std::string_view one = without_blanks(cookie.substr(0, end));
    if (one.starts_with(kCookie)) return one.substr(kCookie.size());
    cookie.remove_prefix(std::min(end + 1, cookie.size()));
  }
  return {};
}

std::optional<std::string> decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hex_value(text[i + 1]), low = hex_value(text[i + 2]);
    if (high < 0 || low < 0 || (high == 0 && low == 0)) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

bool has_token(const Guard& guard, const Request& request) {
  constexpr std::string_view kBearer = "Bearer ";
  const std::string_view authorization = request.authorization;
  if (authorization.starts_with(kBearer))
    return equal_in_constant_time(without_blanks(authorization.substr(kBearer.size())),
                                  guard.token);
  return equal_in_constant_time(token_of_cookie(request.cookie), guard.token);
}

/// Whether the reverse proxy of this machine passes the request on.
bool is_proxied(const Guard& guard, const Request& request) {
  return !guard.proxied.empty() && request.from_here && request.host == guard.proxied;
}

/// Methods other than these four are answered with those that an address has.
bool is_change(Method method) { return method != Method::kGet && method != Method::kOther; }

/// Types that no form of another site can send.
bool is_own_type(std::string_view type) {
  const std::string_view kind = without_blanks(type.substr(0, type.find(';')));
  return kind == "application/json" || kind == "model/gltf-binary";
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& common_headers() {
  static const std::vector<std::pair<std::string, std::string>> headers{
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
       "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cache-Control", "no-store"}};
  return headers;
}

Answer refusal(int status, std::string_view line) {
  // Bytes that are no UTF-8 may come from a request.
  const nlohmann::json body{{"error", line}};
  return {status,
          "application/json",
          body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
          {}};
}

Answer refusal(const Error& error) {
  int status = 500;
  switch (error.code) {
    case ErrorCode::kUsage:
      status = 400;
      break;
    case ErrorCode::kFormat:
      status = 422;
      break;
    case ErrorCode::kNotFound:
      status = 404;
      break;
    case ErrorCode::kUnsupported:
    case ErrorCode::kData:
      status = 409;
      break;
    case ErrorCode::kTimeout:
      status = 503;
      break;
    case ErrorCode::kIo:
    case ErrorCode::kDevice:
      break;
  }
  return refusal(status, to_line(error));
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;  // the length of a token is no secret
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i])) ^
                  static_cast<unsigned>(static_cast<unsigned char>(b[i]));
  return difference == 0;
}

std::optional<Answer> refuse(const Guard& guard, const Request& request) {
  if (request.host.empty()) return refusal(400, "the request has no Host");
  if (guard.token.empty() && !is_loopback_name(request.host))
    return refusal(403, "this page is served to this machine alone: open it as 127.0.0.1");
  const std::string own = (is_proxied(guard, request) ? "https://" : "http://") + request.host;
  if (!request.origin.empty() && request.origin != own)
    return refusal(403, "the request comes from a page of another site");
  const bool elsewhere = request.fetch_site == "cross-site" || request.fetch_site == "same-site";
  if (elsewhere && request.target != "/")
    return refusal(403, "the request comes from a page of another site");
  if (!guard.token.empty() && !has_token(guard, request))
    return refusal(401, "a token is needed: open the page by the address that mixrig run printed");
  if (is_change(request.method) && !is_own_type(request.content_type))
    return refusal(415, "changes need Content-Type: application/json");
  return std::nullopt;
}

std::optional<Answer> first_visit(const Guard& guard, const Request& request) {
  constexpr std::string_view kStart = "/?token=";
  if (guard.token.empty() || request.method != Method::kGet || !request.target.starts_with(kStart))
    return std::nullopt;
  if (!equal_in_constant_time(request.target.substr(kStart.size()), guard.token))
    return refusal(401,
                   "this token is wrong: open the page by the address that mixrig run printed");
  // Lax: a link clicked in a chat is a navigation that another site began, and a strict cookie
  // would not be sent on the redirect. Changes are checked by their Origin.
  std::string cookie = std::string(kCookie) + guard.token + "; Path=/; HttpOnly; SameSite=Lax";
  if (is_proxied(guard, request)) cookie += "; Secure";
  return Answer{303, "text/plain", "", {{"Location", "/"}, {"Set-Cookie", std::move(cookie)}}};
}

std::string random_token() {
  std::array<std::uint8_t, 16> bytes{};
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::getrandom(bytes.data() + done, bytes.size() - done, 0);
    if (got > 0) done += static_cast<std::size_t>(got);
  }
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::optional<std::vector<std::string>> path_of(std::string_view target) {
  if (target.empty() || target.front() != '/' || target.size() > kMostTarget) return std::nullopt;
  target = target.substr(1, target.find('?') - 1);
  std::vector<std::string> parts;
  while (!target.empty()) {
    const std::size_t end = std::min(target.find('/'), target.size());
    auto part = decoded(target.substr(0, end));
    if (!part || part->empty()) return std::nullopt;
    parts.push_back(*std::move(part));
    target.remove_prefix(std::min(end + 1, target.size()));
  }
  return parts;
}

}  // namespace mixrig::page
