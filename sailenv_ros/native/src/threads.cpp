#include "threads.h"

#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace sailenv {
namespace {

constexpr int64_t MOST_WORKERS = 255;

// Rounding to nearest with denormals, whatever the program around has set: the bytes of a result
// must not depend on the thread that makes it.
class FloatEnvironment {
public:
    FloatEnvironment() : before_(control()) { set_control(PLAIN); }
    ~FloatEnvironment() { set_control(before_); }
    FloatEnvironment(const FloatEnvironment&) = delete;
    FloatEnvironment& operator=(const FloatEnvironment&) = delete;

private:
#if defined(__x86_64__)
    static constexpr uint64_t PLAIN = 0x1f80;  // MXCSR: all exceptions masked
    static uint64_t control() { return _mm_getcsr(); }
    static void set_control(uint64_t value) { _mm_setcsr(static_cast<unsigned>(value)); }
#elif defined(__aarch64__)
    static constexpr uint64_t PLAIN = 0;  // FPCR: no traps, no flush to zero
    static uint64_t control() {
        uint64_t value;
        __asm__ volatile("mrs %0, fpcr" : "=r"(value));
        return value;
    }
    static void set_control(uint64_t value) { __asm__ volatile("msr fpcr, %0" : : "r"(value)); }
#else
    static constexpr uint64_t PLAIN = 0;  // what a program begins with
    static uint64_t control() { return PLAIN; }
    static void set_control(uint64_t) {}
#endif
    uint64_t before_;
};

struct Job {
    TileFunction function;
    void* context;
    int64_t tiles;
    std::atomic<int64_t> next_tile{0};
    // The others are guarded by the pool's mutex.
    int64_t free_slots;
    int64_t next_slot = 1;
    int64_t helpers = 0;
    std::condition_variable done{};

    void work(int64_t slot) {
        for (;;) {
            const int64_t tile = next_tile.fetch_add(1, std::memory_order_relaxed);
            if (tile >= tiles) return;
            function(context, tile, slot);
        }
    }
};

class Pool {
public:
    void run(int64_t threads, int64_t tiles, TileFunction function, void* context) {
        const int64_t wanted = std::min(threads, tiles) - 1;
        Job job{function, context, tiles, {}, wanted};
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            start_workers(wanted);
            jobs_.push_back(&job);
        }
        if (wanted == 1) {
            work_.notify_one();
        } else {
            work_.notify_all();
        }
        {
            const FloatEnvironment environment;
            job.work(0);
        }
        std::unique_lock<std::mutex> lock(mutex_);
        jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
        job.done.wait(lock, [&job] { return job.helpers == 0; });
    }

private:
    void start_workers(int64_t wanted) {
        while (workers_ < std::min(wanted, MOST_WORKERS)) {
            // Signals are for the threads of the program.
            sigset_t all, before;
            sigfillset(&all);
            pthread_sigmask(SIG_SETMASK, &all, &before);
            bool started = true;
            try {
                std::thread([this] { serve(); }).detach();
            } catch (const std::system_error&) {
                started = false;
            }
            pthread_sigmask(SIG_SETMASK, &before, nullptr);
            // The calling thread does the work of those that the system does not grant.
            if (!started) return;
            workers_++;
        }
    }

    void serve() {
        const FloatEnvironment environment;
        std::unique_lock<std::mutex> lock(mutex_);
        for (;;) {
            const auto found = std::find_if(jobs_.begin(), jobs_.end(),
                                            [](const Job* job) { return job->free_slots > 0; });
            if (found == jobs_.end()) {
                work_.wait(lock);
                continue;
            }
            Job& job = **found;
            job.free_slots--;
            job.helpers++;
            const int64_t slot = job.next_slot++;
            lock.unlock();
            job.work(slot);
            lock.lock();
            if (--job.helpers == 0) job.done.notify_one();
        }
    }

    std::mutex mutex_;
    std::condition_variable work_;
    std::vector<Job*> jobs_;
    int64_t workers_ = 0;
};

// Never destroyed: its threads may still wait when the process ends.
std::atomic<Pool*> the_pool{nullptr};

// A forked child has none of the threads, and a mutex may be held for good: it makes its own pool.
void forget_pool() { the_pool.store(nullptr); }

Pool& pool() {
    Pool* found = the_pool.load(std::memory_order_acquire);
    if (found != nullptr) return *found;
    static const int registered = pthread_atfork(nullptr, nullptr, forget_pool);
    (void)registered;
    Pool* made = new Pool;
    if (the_pool.compare_exchange_strong(found, made)) return *made;
    delete made;
    return *found;
}

}  // namespace

void run_tiles(int64_t threads, int64_t tiles, TileFunction function, void* context) {
    if (tiles <= 0) return;
    if (threads <= 1 || tiles == 1) {
        const FloatEnvironment environment;
        for (int64_t tile = 0; tile < tiles; tile++) function(context, tile, 0);
        return;
    }
    pool().run(threads, tiles, function, context);
}

}  // namespace sailenv
