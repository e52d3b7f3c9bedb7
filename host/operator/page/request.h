// SPDX-License-Identifier: Apache-2.0
// HTTP requests as values: who may ask, what is asked, what is answered. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::page {

enum class Method { kGet, kPut, kPost, kDelete, kOther };

/// The parts of a request that decide; header fields are empty where they are absent.
struct Request {
  Method method = Method::kGet;
  std::string target;
  std::string host, origin, content_type, authorization, cookie, fetch_site;
};

struct Answer {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers{};
};

/// Who may use the page.
struct Guard {
  std::string token;  ///< empty: everybody on this machine, by a name of the loop-back address
};

/// Headers of every answer: nothing from elsewhere is loaded, nobody else shows the page.
const std::vector<std::pair<std::string, std::string>>& common_headers();

/// `{"error": line}` with a status.
Answer refusal(int status, std::string_view line);
/// The status that tells an error's code.
Answer refusal(const Error& error);

/// True where both are equal; takes the same time wherever they differ.
bool equal_in_constant_time(std::string_view a, std::string_view b);

/// Why the request is not served, if so: a Host that is not the loop-back address without a token
/// (a name that somebody pointed at this machine), an Origin that is not the Host, a site that the
/// browser says is another one (but for the page itself, which a link may lead to), a missing or
/// wrong token, a change that is not JSON (or a model).
std::optional<Answer> refuse(const Guard& guard, const Request& request);

/// Where the page is opened with ?token=TOKEN that is right: the answer that sets the cookie and
/// leads to the address without it.
std::optional<Answer> first_visit(const Guard& guard, const Request& request);

/// 128 bits of the kernel as 32 hexadecimal digits.
std::string random_token();

/// The parts of a target between its slashes, without its query, %XX decoded: {"api", "v1",
/// "state"} of "/api/v1/state?x"; none of "/". Empty where it is damaged: no leading '/', a wrong
/// or zero %XX, an empty part, longer than 512 bytes.
std::optional<std::vector<std::string>> path_of(std::string_view target);

}  // namespace mixrig::page
