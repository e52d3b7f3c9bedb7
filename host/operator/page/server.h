// SPDX-License-Identifier: Apache-2.0
// Serves the operator's page and its interface: HTTP/1.1 and WebSocket in one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/operator/page/operator.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"

namespace mixrig::page {

inline constexpr std::uint16_t kDefaultPort = 8437, kDefaultOscPort = 8438;

struct Listen {
  std::string address = "127.0.0.1";
  std::uint16_t port = kDefaultPort;  ///< 0: one that is free
};

/// "", "ADDRESS", "ADDRESS:PORT", "[ADDRESS]:PORT", "localhost:PORT". Errors: kUsage.
Result<Listen> parse_listen(std::string_view text);
/// The same of --osc-in, and "PORT".
Result<Listen> parse_osc_listen(std::string_view text);

/// At most 16 connections, headers of 8 KiB, bodies of 64 KiB (a model: 64 MiB, into a temporary
/// file), 30 s without a request. On the loop-back address the page is for this machine alone; on
/// another one a token is needed, which url() has.
class Server {
 public:
  /// With `osc_in` it takes OSC there too. `run` and `clock` outlive it, `orders` its sink too.
  /// Errors: kUsage for an address that this machine does not have; kIo where the port is taken.
  static Result<std::unique_ptr<Server>> start(Operator& run, output::RunOrders& orders,
                                               const Clock& clock, const Listen& listen,
                                               const std::optional<Listen>& osc_in = {});
  /// Ends all connections, and a command that is at work.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Where to open the page, with the token where one is needed.
  const std::string& url() const;
  std::uint16_t port() const;
  /// "127.0.0.1:8438", and what addresses begin with: "/mixrig" or "/TOKEN/mixrig". Empty without.
  const std::string& osc_text() const;
  std::uint16_t osc_port() const;
  /// The sink that the pictures come from. It may outlive the server.
  std::unique_ptr<output::CompositeSink> make_sink() const;

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mixrig::page
