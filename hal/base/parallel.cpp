// SPDX-License-Identifier: Apache-2.0
#include "hal/base/parallel.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include <sched.h>

namespace mixrig {
namespace {

// Fields of Crew::call_.
constexpr std::uint32_t kWorker = 1, kOpen = 1U << 12, kNumber = kOpen << 1;
constexpr std::uint32_t workers_of(std::uint32_t call) { return call & (kOpen - 1); }
constexpr std::uint32_t number_of(std::uint32_t call) { return call / kNumber; }

/// How long a thread polls for a change before it sleeps.
constexpr std::chrono::microseconds kLook{50};

/// Tells the processor that a loop waits for another core.
void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Returns the cores that the calling thread may use; empty if the system does not report them.
std::vector<int> allowed_cores() {
  cpu_set_t set;
  std::vector<int> cores;
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &set)) cores.push_back(i);
  return cores;
}

void keep_on(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  (void)::sched_setaffinity(0, sizeof(set), &set);
}

/// Keeps the calling thread on the first of `cores`; the destructor restores its cores.
class OnFirstCore {
 public:
  explicit OnFirstCore(std::span<const int> cores) {
    if (cores.empty() || ::sched_getaffinity(0, sizeof(before_), &before_) != 0) return;
    kept_ = true;
    keep_on(cores.front());
  }
  ~OnFirstCore() {
    if (kept_) (void)::sched_setaffinity(0, sizeof(before_), &before_);
  }
  OnFirstCore(const OnFirstCore&) = delete;
  OnFirstCore& operator=(const OnFirstCore&) = delete;

 private:
  bool kept_ = false;
  cpu_set_t before_;
};

/// One call of a crew. What a band throws ends the call: bands that begin later do nothing.
struct Call {
  void (*function)(void*, int, int, int);
  void* context;
  std::atomic<bool> failed = false;
  std::exception_ptr error =
      nullptr;  ///< what the first one threw, written by the thread that set `failed`
};

/// Calls the function of a Call for one band.
void call_guarded(void* context, int worker, int begin, int end) {
  Call& call = *static_cast<Call*>(context);
  if (call.failed.load(std::memory_order_relaxed)) return;
  try {
    call.function(call.context, worker, begin, end);
  } catch (...) {
    if (!call.failed.exchange(true)) call.error = std::current_exception();
  }
}

}  // namespace

Crew::Crew(int threads) : cores_(allowed_cores()) {
  const int total = threads > 0 ? threads : std::max(1, static_cast<int>(cores_.size()));
  if (total != static_cast<int>(cores_.size())) cores_.clear();
  for (int i = 1; i < total; ++i) workers_.emplace_back([this, i] { work(i); });
}

Crew::~Crew() {
  stop_ = true;
  call_.fetch_add(kNumber);
  call_.notify_all();
  for (auto& worker : workers_) worker.join();
}

/// Waits until differs(call_), and returns that call_.
template <typename Differs>
std::uint32_t Crew::await(Differs&& differs) {
  std::uint32_t call = call_.load(std::memory_order_acquire);
  if (differs(call)) return call;
  if (!cores_.empty()) {
    const auto end = std::chrono::steady_clock::now() + kLook;
    do {
      for (int i = 0; i < 16; ++i) {
        relax();
        call = call_.load(std::memory_order_acquire);
        if (differs(call)) return call;
      }
    } while (std::chrono::steady_clock::now() < end);
  }
  while (!differs(call)) {
    call_.wait(call, std::memory_order_acquire);
    call = call_.load(std::memory_order_acquire);
  }
  return call;
}

void Crew::run(int count, int grain, Function function, void* context) {
  if (count <= 0) return;
  grain = std::max(1, grain);
  if (workers_.empty() || count <= grain) {
    for (int begin = 0; begin < count; begin += grain)
      function(context, 0, begin, std::min(begin + grain, count));
    return;
  }
  const OnFirstCore caller(cores_);
  Call made{function, context};
  function_ = call_guarded, context_ = &made, count_ = count, grain_ = grain;
  next_.store(0, std::memory_order_relaxed);
  // Nobody works on a closed call, so that no other thread changes call_ here.
  call_.store((number_of(call_.load(std::memory_order_relaxed)) + 1) * kNumber + kOpen);
  call_.notify_all();
  take_bands(0);
  call_.fetch_sub(kOpen);
  await([](std::uint32_t call) { return workers_of(call) == 0; });
  if (made.failed) std::rethrow_exception(made.error);
}

void Crew::take_bands(int worker) {
  for (int begin; (begin = next_.fetch_add(grain_, std::memory_order_relaxed)) < count_;)
    function_(context_, worker, begin, std::min(begin + grain_, count_));
}

void Crew::work(int worker) {
  if (!cores_.empty()) keep_on(cores_[static_cast<std::size_t>(worker)]);
  for (std::uint32_t seen = 0; !stop_;) {
    std::uint32_t call = await([&](std::uint32_t c) { return number_of(c) != seen; });
    seen = number_of(call);
    while (call & kOpen && number_of(call) == seen)
      if (call_.compare_exchange_weak(call, call + kWorker)) {
        take_bands(worker);
        // The caller may sleep until the last one leaves.
        if (workers_of(call_.fetch_sub(kWorker)) == 1) call_.notify_all();
        break;
      }
  }
}

}  // namespace mixrig
