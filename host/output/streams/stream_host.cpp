// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/stream_host.h"

#include <array>
#include <memory>

#include <netdb.h>
#include <sys/socket.h>

namespace mixrig::output {

Result<std::string> numeric_host(const std::string& host) {
  const bool brackets = host.starts_with('[') && host.ends_with(']');
  const std::string name = brackets ? host.substr(1, host.size() - 2) : host;
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int fault = ::getaddrinfo(name.c_str(), nullptr, &wanted, &found);
  if (fault != 0)
    return Error{ErrorCode::kUsage, "the host \"" + name + "\" is not known (" +
                                        ::gai_strerror(fault) +
                                        "): correct it, or give its address"};
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, ::freeaddrinfo);
  const addrinfo* chosen = found;
  for (const addrinfo* a = found; a != nullptr; a = a->ai_next)
    if (a->ai_family == AF_INET) {
      chosen = a;
      break;
    }
  std::array<char, NI_MAXHOST> text{};
  ::getnameinfo(chosen->ai_addr, chosen->ai_addrlen, text.data(), text.size(), nullptr, 0,
                NI_NUMERICHOST);
  return std::string(text.data());
}

}  // namespace mixrig::output
