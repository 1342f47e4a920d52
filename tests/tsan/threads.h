// SPDX-License-Identifier: Apache-2.0
// What the project uses of oneTBB, on std::thread: for ThreadSanitizer, which does not see how
// Debian's uninstrumented libtbb hands work from thread to thread and would report all of it. Ranges
// are cut small and taken by four threads in any order; nothing orders the pieces of one call but its
// beginning and its end, so that a race between two of them is seen.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tbb {
namespace shim {

inline constexpr int kThreads = 4;
inline thread_local int depth = 0;  // calls around this one; inner ones stay in their thread

// run(piece) for pieces 0 .. n - 1.
template <class F>
void run_pieces(size_t n, const F& run) {
  if (depth > 0 || n < 2) {
    for (size_t i = 0; i < n; ++i) run(i);
    return;
  }
  std::atomic<size_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto work = [&] {
    ++depth;
    try {
      for (size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < n;) run(i);
    } catch (...) {
      const std::lock_guard lock(error_mutex);
      error = std::current_exception();
    }
    --depth;
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < kThreads; ++t) threads.emplace_back(work);
  work();
  for (std::thread& t : threads) t.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace shim

template <class T>
class blocked_range {
 public:
  blocked_range(T begin, T end, size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}
  T begin() const { return begin_; }
  T end() const { return end_; }
  size_t grain() const { return grain_; }

 private:
  T begin_, end_;
  size_t grain_;
};

template <class T, class F>
void parallel_for(const blocked_range<T>& range, const F& f) {
  const auto size = static_cast<size_t>(range.end() - range.begin());
  const size_t step = std::max<size_t>({size_t{1}, range.grain(), size / 16});
  shim::run_pieces((size + step - 1) / step, [&](size_t i) {
    f(blocked_range<T>(static_cast<T>(range.begin() + i * step),
                       static_cast<T>(range.begin() + std::min(size, (i + 1) * step))));
  });
}

template <class T, class F>
void parallel_for(T begin, T end, const F& f) {
  if (!(begin < end)) return;
  parallel_for(blocked_range<T>(begin, end), [&](const blocked_range<T>& piece) {
    for (T i = piece.begin(); i < piece.end(); ++i) f(i);
  });
}

template <class A, class B>
void parallel_invoke(const A& a, const B& b) {
  shim::run_pieces(2, [&](size_t i) { i == 0 ? a() : b(); });
}

class task_arena {
 public:
  explicit task_arena(int threads) : threads_(threads) {}
  template <class F>
  auto execute(const F& f) {
    struct Inside {
      int was = shim::depth;
      ~Inside() { shim::depth = was; }
    } inside;
    if (threads_ == 1) ++shim::depth;
    return f();
  }

 private:
  int threads_;
};

class global_control {
 public:
  enum parameter { max_allowed_parallelism };
  global_control(parameter, size_t) {}
};

namespace info {
inline int default_concurrency() { return shim::kThreads; }
}  // namespace info

}  // namespace tbb
