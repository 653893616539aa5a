// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace crofton {

struct ThreadPool::State {
    struct Job {
        RangeTask body;
        std::size_t count, grain;
        std::atomic<std::size_t> next{0};
    };

    std::mutex one_caller;  // serialises parallel_for
    std::mutex mutex;       // guards what follows
    std::condition_variable wake, done;
    Job* job = nullptr;
    std::atomic<std::size_t> generation{0};  // written under the mutex
    unsigned asleep = 0;
    std::atomic<unsigned> busy{0};  // written under the mutex
    bool quit = false;
    std::vector<std::thread> threads;

    static thread_local const State* working_for;

    static void run(Job& job, unsigned worker) {
        for (;;) {
            const std::size_t begin = job.next.fetch_add(job.grain);
            if (begin >= job.count) return;
            job.body(begin, std::min(job.count, begin + job.grain), worker);
        }
    }

    // Calls come close after each other, and waking a thread that sleeps takes longer than many of them. Not by
    // yielding: a thread that yields may stay on the processor of the caller, and behind it.
    void await_next(std::size_t seen) const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(50);
        while (generation.load(std::memory_order_relaxed) == seen && std::chrono::steady_clock::now() < end) {
        }
    }

    void work(unsigned worker) {
        working_for = this;
        std::size_t seen = 0;
        std::unique_lock lock(mutex);
        for (;;) {
            if (!quit && generation == seen) {
                lock.unlock();
                await_next(seen);
                lock.lock();
            }
            ++asleep;
            wake.wait(lock, [&] { return quit || generation != seen; });
            --asleep;
            if (quit) return;
            seen = generation;
            if (!job) continue;  // the others finished it before this thread woke
            Job& mine = *job;
            ++busy;
            lock.unlock();
            run(mine, worker);
            lock.lock();
            if (--busy == 0) done.notify_all();
        }
    }
};

thread_local const ThreadPool::State* ThreadPool::State::working_for = nullptr;

ThreadPool::ThreadPool(unsigned threads) : state_(Owner<State>::make()) {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    threads = std::min(threads, 1024u);
    state_->threads.reserve(threads - 1);
    try {
        for (unsigned worker = 1; worker < threads; ++worker)
            state_->threads.emplace_back([state = state_.get(), worker] { state->work(worker); });
    } catch (const std::system_error&) {  // the system starts no more
    }
}

ThreadPool::~ThreadPool() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->quit = true;
    }
    state_->wake.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

unsigned ThreadPool::concurrency() const {
    return static_cast<unsigned>(state_->threads.size()) + 1;
}

void ThreadPool::parallel_for(std::size_t count, std::size_t grain, RangeTask body) {
    CROFTON_ASSERT(grain >= 1, "parallel_for needs a grain of at least 1");
    if (count == 0) return;
    // A nested call must not hand worker numbers to others while this worker's own body is still running.
    CROFTON_ASSERT(State::working_for != state_.get(), "parallel_for called from inside a body of the same pool");
    const std::lock_guard one_caller(state_->one_caller);
    grain = std::min(grain, count);  // the same ranges, and `next` does not overflow
    State::Job job{body, count, grain, {}};
    bool wakes = false;
    {
        const std::lock_guard lock(state_->mutex);
        state_->job = &job;
        ++state_->generation;
        wakes = state_->asleep > 0;
    }
    if (wakes && count > grain) state_->wake.notify_all();
    const State* outer = State::working_for;
    State::working_for = state_.get();
    State::run(job, 0);
    State::working_for = outer;
    std::unique_lock lock(state_->mutex);
    state_->job = nullptr;  // who has not begun by now never does
    // The others are at their last ranges, most of which end sooner than this thread could sleep and wake.
    lock.unlock();
    for (int spin = 0; spin < 10000 && state_->busy.load() > 0; ++spin) {
    }
    lock.lock();
    state_->done.wait(lock, [&] { return state_->busy == 0; });
}

}  // namespace crofton
