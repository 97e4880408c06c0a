// SPDX-License-Identifier: Apache-2.0
#include "view_node/recorded_curves.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/failure.h"
#include "plotting/decimation.h"
#include "session/recorded.h"

namespace slew::view_node {
namespace {

constexpr int kPlaybackFirst = 5;  // niceness

std::uint64_t nanoseconds(double seconds) {
  return static_cast<std::uint64_t>(std::llround(seconds * 1e9));
}

}  // namespace

RecordedCurves::RecordedCurves(std::vector<Recording> recordings)
    : recordings_(std::move(recordings)), thread_([this] { work(); }) {}

RecordedCurves::~RecordedCurves() {
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true;
  }
  has_changed_.notify_one();
  thread_.join();
}

std::vector<std::string> RecordedCurves::names() const {
  std::vector<std::string> names;
  for (const Recording& recording : recordings_) names.push_back(recording.name);
  return names;
}

void RecordedCurves::read(gateway::CurvesRequest request, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMostWaiting) {
      waiting_.push_back({std::move(request), std::move(done)});
      done = nullptr;
    }
  }
  if (done) return done({.problem = "too many requests for curves wait; nothing was read; try again"});
  has_changed_.notify_one();
}

void RecordedCurves::poll() {
  std::deque<Job> answered;
  {
    const std::lock_guard lock(mutex_);
    answered.swap(answered_);
  }
  for (Job& job : answered) job.done(std::move(job.answer));
}

void RecordedCurves::work() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kPlaybackFirst);  // without it the answers come as well
  std::unique_lock lock(mutex_);
  while (true) {
    has_changed_.wait(lock, [this] { return is_closing_ || !waiting_.empty(); });
    if (is_closing_) return;
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    try {
      job.answer = answer(job.request);
    } catch (const std::exception& error) {
      job.answer = {.problem = error.what()};
    }
    lock.lock();
    answered_.push_back(std::move(job));
  }
}

RecordedCurves::Answer RecordedCurves::answer(const gateway::CurvesRequest& request) const {
  const recording::Reader& reader = *recordings_.at(request.recording).reader;
  const std::vector<std::string> recorded = session::recorded_names(reader);
  std::vector<std::string> names;
  std::ranges::copy_if(request.names, std::back_inserter(names), [&](const std::string& name) {
    return std::ranges::find(recorded, name) != recorded.end() && std::ranges::find(names, name) == names.end();
  });
  Answer answer;
  if (names.empty()) return answer;
  std::vector<plotting::Series> curves =
      session::read_series(reader, names, session::Units::si, {nanoseconds(request.from), nanoseconds(request.to)});
  plotting::part_at_gaps(curves);
  answer.samples = plotting::thin_out(curves, request.most_values);
  for (const plotting::Series& curve : curves)
    answer.curves.push_back(
        {{"name", curve.name}, {"unit", curve.unit}, {"times", curve.time}, {"values", curve.values}});
  return answer;
}

}  // namespace slew::view_node
