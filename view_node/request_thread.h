// SPDX-License-Identifier: Apache-2.0
// Requests of a page whose answers take their time: they are answered one after the other on a thread of low priority,
// and the answers are given back on the thread of the server.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace slew::view_node {

template <typename Request, typename Answer>
class RequestThread {
 public:
  using Work = std::function<Answer(const Request&)>;  // on the thread; does not throw
  using Done = std::function<void(Answer)>;

  // most_waiting: requests that no answer is being made for. niceness: of the thread.
  RequestThread(std::size_t most_waiting, int niceness, Work work)
      : most_waiting_(most_waiting), work_(std::move(work)), thread_([this, niceness] { run(niceness); }) {}
  RequestThread(const RequestThread&) = delete;
  RequestThread& operator=(const RequestThread&) = delete;
  // Waits for the request that is being answered; others get no answer.
  ~RequestThread() {
    {
      const std::lock_guard lock(mutex_);
      is_closing_ = true;
    }
    has_changed_.notify_one();
    thread_.join();
  }

  // done is called once, from poll(). False: too many requests wait, and this one was not taken.
  [[nodiscard]] bool take(Request request, Done done) {
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.size() >= most_waiting_) return false;
      waiting_.push_back({std::move(request), std::move(done)});
    }
    has_changed_.notify_one();
    return true;
  }
  void poll() {
    std::deque<Job> answered;
    {
      const std::lock_guard lock(mutex_);
      answered.swap(answered_);
    }
    for (Job& job : answered) job.done(std::move(job.answer));
  }

 private:
  struct Job {
    Request request;
    Done done;
    Answer answer{};
  };

  void run(int niceness) {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);  // without it the answers come as well
    std::unique_lock lock(mutex_);
    while (true) {
      has_changed_.wait(lock, [this] { return is_closing_ || !waiting_.empty(); });
      if (is_closing_) return;
      Job job = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      job.answer = work_(job.request);
      lock.lock();
      answered_.push_back(std::move(job));
    }
  }

  const std::size_t most_waiting_;
  const Work work_;
  std::mutex mutex_;  // of all below
  std::condition_variable has_changed_;
  std::deque<Job> waiting_, answered_;
  bool is_closing_ = false;
  std::thread thread_;
};

}  // namespace slew::view_node
