// SPDX-License-Identifier: Apache-2.0
// The viewfinder as a sink: shows every composite in a window, in a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "hal/base/bounded_queue.h"
#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "host/capture/capture/capture_source.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"
#include "host/output/sink/shown_log.h"
#include "host/output/viewfinder/view_state.h"

namespace mixrig::viewfinder {

struct ViewfinderOptions {
  std::string title = "mixrig";
  View view = View::kComposite;
  Size picture_px;  ///< size of the window on a desktop
  bool help = false;
  bool shares = false;              ///< composites may stay in the GPU's memory (Viewfinder::share)
  output::ShownLog* log = nullptr;  ///< for a measurement; must outlive the sink
};

/// Of a run; complete when the sink has finished.
struct ViewfinderReport {
  std::string driver;                ///< SDL's: "x11, software"
  std::uint64_t shown = 0;           ///< composites
  std::uint64_t replaced = 0;        ///< by newer ones before they were shown
  measure::QuantileSketch show_ms;   ///< composite handed over to shown
  measure::QuantileSketch delay_ms;  ///< live: mid-exposure to shown
};

/// Shows the view that the run's state has, and gives the orders of keys. write() hands the
/// composite to the thread that owns the window, and does not wait for it; that thread draws,
/// shows, handles keys, and goes on while no composite comes: a picture that is old says so.
/// Closing the window ends the run as Ctrl-C does.
class Viewfinder final : public output::CompositeSink {
 public:
  /// Opens the window. Source, orders, clock and report must outlive the sink. The source is
  /// asked for the state of its devices twice a second. Errors: those of Window::open.
  static Result<std::unique_ptr<Viewfinder>> create(const ViewfinderOptions& options,
                                                    const capture::CaptureSource& source,
                                                    output::RunOrders& orders, const Clock& clock,
                                                    ViewfinderReport& report);
  ~Viewfinder() override;

  /// What the run's compositors share with the window, so that their composites need not be read
  /// back; empty where SDL draws otherwise, or `shares` was not wanted. They end before the sink.
  render::GlShare share() const { return share_; }
  /// Composites are read back all the same. Before the run begins.
  void forget_share() { share_ = {}; }

  std::string_view name() const override { return "viewfinder"; }
  render::OutputMask wanted(int number) const override;
  /// Errors: kDevice where the picture could not be shown.
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override;

 private:
  struct Handed {
    output::CompositePtr composite;
    HostTime at{};
  };
  class Loop;

  Viewfinder(const ViewfinderOptions& options, const capture::CaptureSource& source,
             output::RunOrders& orders, const Clock& clock, ViewfinderReport& report);
  void stop();

  const ViewfinderOptions options_;
  const capture::CaptureSource& source_;
  output::RunOrders& orders_;
  const Clock& clock_;
  ViewfinderReport& report_;
  std::atomic<bool> reads_pixels_ = false;  ///< of the composite, to draw marks of them
  render::GlShare share_;
  BoundedQueue<Handed, 1> queue_;
  std::atomic<bool> over_ = false;
  std::atomic<bool> failed_ = false;
  std::optional<Error> error_;  ///< of the thread; read after failed_
  std::thread thread_;
};

}  // namespace mixrig::viewfinder
