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
  std::uint16_t port = kDefaultPort;  ///< 0: a free port is chosen
  std::string proxied{};              ///< Guard::proxied
  std::string token_file{};           ///< path of the token's file; empty: none
};

/// Parses "", "ADDRESS", "ADDRESS:PORT", "[ADDRESS]:PORT" or "localhost:PORT". Errors: kUsage.
Result<Listen> parse_listen(std::string_view text);
/// Checks the name of --page-proxy: "HOST" or "HOST:PORT". Errors: kUsage.
Result<void> check_proxied(std::string_view name);
/// Parses the address of --osc-in, which may also be "PORT". Errors: kUsage.
Result<Listen> parse_osc_listen(std::string_view text);

/// Serves at most 16 connections of an address and 32 of all, beside 32 that have sent no permitted
/// request yet (Visitors), the first header within 5 s, headers of 8 KiB, bodies of 64 KiB (a
/// model: 64 MiB, into a temporary file), 30 s without a request. On the loop-back address the page
/// is for this machine alone; on another one, and through a
/// reverse proxy of this machine, it needs a token, which url() contains. With a token's file it
/// needs that token everywhere; a file that is changed or removed renews it, which ends all
/// connections.
class Server {
 public:
  /// Starts serving; with `osc_in` it also receives OSC at that address. `run` and `clock` outlive
  /// the server, `orders` also its sink. Errors: kUsage for an address that this machine does not
  /// have, or a token's file that others may read; kIo where the port is taken; kUnsupported where
  /// GStreamer does not start.
  static Result<std::unique_ptr<Server>> start(Operator& run, output::RunOrders& orders,
                                               const Clock& clock, const Listen& listen,
                                               const std::optional<Listen>& osc_in = {});
  /// Ends all connections and waits for a running command.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Address of the page, with the token if one is needed and has no file.
  const std::string& url() const;
  std::uint16_t port() const;
  /// Address for OSC and prefix of its messages: "127.0.0.1:8438, addresses begin with /mixrig/".
  /// Empty without OSC.
  const std::string& osc_text() const;
  std::uint16_t osc_port() const;
  /// Makes the sink that provides the pictures. It may outlive the server.
  std::unique_ptr<output::CompositeSink> make_sink() const;

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mixrig::page
