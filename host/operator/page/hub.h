// SPDX-License-Identifier: Apache-2.0
// State that the connections of the page share. All but the pictures belongs to the server's
// thread. Private to this module.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <set>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/thread_pool.hpp>

#include "hal/base/clock.h"
#include "host/operator/page/operator.h"
#include "host/operator/page/pictures/pictures.h"
#include "host/operator/page/request.h"
#include "host/operator/page/route.h"
#include "host/operator/page/state_json.h"
#include "host/operator/page/visitors.h"
#include "host/output/sink/run_orders.h"

namespace mixrig::page {

class EventSocket;
class OscPort;
class PictureStream;
class WebrtcPeer;
class WebrtcSocket;

/// Posts work to the server's thread from threads that may outlive it.
class Outlet {
 public:
  explicit Outlet(boost::asio::io_context& io) : io_(&io) {}
  void post(std::function<void()> work);
  /// Stops posting: later work is dropped.
  void close();

 private:
  std::mutex mutex_;
  boost::asio::io_context* io_;
};

/// Address of the other side; empty where it is gone.
std::string remote_address(const boost::asio::ip::tcp::socket& socket);

/// Whether the other side is a program of this machine, by the loop-back address.
bool is_of_this_machine(const boost::asio::ip::tcp::socket& socket);

struct Hub {
  Hub(Operator& run, output::RunOrders& run_orders, const Clock& host_clock)
      : op(run),
        orders(run_orders),
        clock(host_clock),
        pictures(std::make_shared<Pictures>(run_orders)) {}

  /// Current state of the run and of the page.
  nlohmann::json state() const;
  /// Runs an action. Orders are given at once; commands run in the work thread, one at a time, and
  /// are refused (kData) while 64 wait. `done` is called on the server's thread.
  void act(Action action, std::function<void(Result<void>)> done);
  /// Gets a picture of a recording as JPEG, in the thread `take_work`, one at a time; refused
  /// (kData) while 8 wait. `done` is called on the server's thread.
  void get_take_picture(GetTakePicture wanted, std::function<void(Result<std::string>)> done);
  /// Sends what changed to every event socket and to the control surfaces that use OSC.
  void tell();
  /// Destroys the peer in `peer_work`, then frees its place among `peers`; null frees the place
  /// only.
  void end_peer(std::shared_ptr<WebrtcPeer> peer);
  /// Does work in `peer_work`; what it throws is logged.
  void post_peer_work(std::function<void()> task);

  Operator& op;
  output::RunOrders& orders;
  const Clock& clock;
  const std::shared_ptr<Pictures> pictures;
  Guard guard;
  Visitors visitors;
  std::set<EventSocket*> sockets;
  std::set<PictureStream*> streams;
  std::set<WebrtcSocket*> peer_sockets;
  int peers = 0;           ///< number of WebRTC peers, with those that begin or end
  OscPort* osc = nullptr;  ///< null: OSC is not received
  constexpr static int kMostAtWork = 64;
  int at_work = 0;  ///< commands that are not done yet
  constexpr static int kMostTakePictures = 8;
  int take_pictures = 0;  ///< pictures of recordings that are not decoded yet
  boost::asio::io_context io{1};
  boost::asio::thread_pool work{1}, take_work{1}, peer_work{1};
  std::shared_ptr<Outlet> outlet = std::make_shared<Outlet>(io);
};

}  // namespace mixrig::page
