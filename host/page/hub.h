// SPDX-License-Identifier: Apache-2.0
// What the connections of the page share. All but the pictures belongs to the server's thread.
// Private to this room.
#pragma once

#include <functional>
#include <memory>
#include <set>

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>

#include "hal/base/clock.h"
#include "host/page/operator.h"
#include "host/page/pictures.h"
#include "host/page/request.h"
#include "host/page/route.h"
#include "host/page/state_json.h"

namespace mixrig::page {

class EventSocket;
class PictureStream;

struct Hub {
  Hub(Operator& run, const Clock& host_clock, std::shared_ptr<Pictures> made)
      : op(run), clock(host_clock), pictures(std::move(made)) {}

  /// Of the run and the page, now.
  nlohmann::json state() const;
  /// Runs an action: those of the run in the work thread, one at a time. `done` is called on the
  /// server's thread.
  void act(Action action, std::function<void(Result<void>)> done);
  /// Tells every event socket what changed.
  void tell();

  Operator& op;
  const Clock& clock;
  const std::shared_ptr<Pictures> pictures;
  Guard guard;
  View view = View::kComposite;
  int connections = 0;
  std::set<EventSocket*> sockets;
  std::set<PictureStream*> streams;
  boost::asio::io_context io{1};
  boost::asio::thread_pool work{1};
};

}  // namespace mixrig::page
