// SPDX-License-Identifier: Apache-2.0
// Checks and answers HTTP requests, as values: permission, target, answer. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::page {

enum class Method { kGet, kPut, kPost, kDelete, kOther };

/// Parts of a request that matter here; absent header fields are empty.
struct Request {
  Method method = Method::kGet;
  std::string target;
  std::string host, origin, content_type, authorization, cookie, fetch_site;
  bool from_here = false;  ///< sent by a program of this machine
};

struct Answer {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers{};
};

/// Permission to use the page.
struct Guard {
  std::string token;  ///< empty: only programs on this machine, by a name of the loop-back address
  /// Host, without "https://", by which a reverse proxy on this machine serves the page; empty:
  /// none. Such a page has a token.
  std::string proxied{};
};

/// Headers of every answer: nothing is loaded from elsewhere, and no other page embeds this one.
const std::vector<std::pair<std::string, std::string>>& common_headers();

/// Answer `{"error": line}` with a status.
Answer refusal(int status, std::string_view line);
/// Answer with the status of an error's code.
Answer refusal(const Error& error);

/// Whether both are equal; takes the same time wherever they differ.
bool equal_in_constant_time(std::string_view a, std::string_view b);

/// Refusal of a request that must not be served, else nullopt. Without a token, a Host other than
/// the loop-back address is refused (a foreign name that resolves to this machine). Also refused:
/// an Origin that is not the Host, with https from the proxy of this machine alone; a site that the
/// browser reports as another one, except for the page itself, which links may lead to; a missing
/// or wrong token; a change that is neither JSON nor a model.
std::optional<Answer> refuse(const Guard& guard, const Request& request);

/// Answer to opening the page with the right ?token=TOKEN: sets the cookie and redirects to the
/// address without it. 401 for a wrong token; nullopt for other requests.
std::optional<Answer> first_visit(const Guard& guard, const Request& request);

/// 128 random bits of the kernel as 32 hexadecimal digits.
std::string random_token();

/// Parts of a target between its slashes, without its query, %XX decoded: {"api", "v1", "state"}
/// for "/api/v1/state?x"; empty for "/". nullopt for a malformed target: no leading '/', a wrong or
/// zero %XX, an empty part, longer than 512 bytes.
std::optional<std::vector<std::string>> path_of(std::string_view target);

}  // namespace mixrig::page
