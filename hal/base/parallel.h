// SPDX-License-Identifier: Apache-2.0
// A fixed set of threads that process bands of rows in parallel. No allocation per call.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

namespace mixrig {

/// Runs one body over bands of [0, count) on a fixed number of threads, including the caller's.
/// One call at a time per crew; the body must not call back into the same crew.
/// With one thread per core each worker stays on a core of its own, and the caller on the remaining
/// one during a call: some systems (Linux as a KVM guest) otherwise wake two of them on the same
/// core while another one idles, which cost a frame up to half of its time. Such threads also poll
/// for the next call for kLook before they sleep, since waking a thread takes longer than many
/// calls. Other numbers of threads are placed by the system and sleep at once.
class Crew {
 public:
  /// `threads` >= 1; 0 means one per core.
  explicit Crew(int threads = 0);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls body(begin, end) for disjoint bands of at most `grain` that cover [0, count);
  /// returns after the last one. The next band, in order, goes to the next free thread.
  template <typename Body>
  void rows(int count, int grain, Body&& body) {
    rows_by_worker(count, grain, [&body](int, int begin, int end) { body(begin, end); });
  }

  /// Does what rows() does, but calls body(worker, begin, end) with worker in [0, threads()). Bands
  /// of one worker never run at the same time, so that each can have its own scratch memory.
  template <typename Body>
  void rows_by_worker(int count, int grain, Body&& body) {
    run(
        count, grain,
        [](void* context, int worker, int begin, int end) {
          (*static_cast<std::remove_reference_t<Body>*>(context))(worker, begin, end);
        },
        &body);
  }

 private:
  using Function = void (*)(void*, int, int, int);
  void run(int count, int grain, Function function, void* context);
  void work(int worker);
  void take_bands(int worker);
  template <typename Differs>
  std::uint32_t await(Differs&& differs);

  /// One core per thread, the caller's first; empty: the system places them.
  std::vector<int> cores_;
  /// Bits from kNumber up: number of the call. Bit kOpen: workers may join it. Bits below: number
  /// of workers in it, without the caller.
  std::atomic<std::uint32_t> call_{0};
  std::atomic<bool> stop_{false};
  // Arguments of the open call, written before it is opened, when all workers have left the last.
  Function function_ = nullptr;
  void* context_ = nullptr;
  int count_ = 0, grain_ = 1;
  std::atomic<int> next_{0};  ///< first row that nobody has taken
  std::vector<std::thread> workers_;
};

}  // namespace mixrig
