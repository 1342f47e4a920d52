// SPDX-License-Identifier: Apache-2.0
// Many tasks, few threads.
#pragma once
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace photonloom {

// Calls f(0) .. f(count - 1) from `workers` threads, each of which has one thread of TBB's: results
// are many, and few of a frame's phases fill more cores than one. Throws what the first call threw.
template <class F>
void each_on_worker(int workers, size_t count, F&& f) {
  std::atomic<size_t> next{0};
  std::atomic<bool> stop{false};
  std::exception_ptr error;
  std::mutex mutex;
  std::vector<std::thread> threads;
  const auto work = [&] {
    tbb::task_arena alone(1);
    alone.execute([&] {
      for (size_t i; !stop && (i = next++) < count;) try {
          f(i);
        } catch (...) {
          const std::lock_guard lock(mutex);
          if (!error) error = std::current_exception();
          stop = true;
        }
    });
  };
  const size_t wanted = std::min(count, static_cast<size_t>(std::max(1, workers)));
  for (size_t t = 0; t < wanted; ++t) threads.emplace_back(work);
  for (std::thread& t : threads) t.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace photonloom
