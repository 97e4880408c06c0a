// SPDX-License-Identifier: Apache-2.0
#include "view_node/recorded_curves.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

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
    : recordings_(std::move(recordings)),
      thread_(kMostWaiting, kPlaybackFirst, [this](const gateway::CurvesRequest& request) { return answer(request); }) {
}

std::vector<std::string> RecordedCurves::names() const {
  std::vector<std::string> names;
  for (const Recording& recording : recordings_) names.push_back(recording.name);
  return names;
}

void RecordedCurves::read(gateway::CurvesRequest request, Done done) {
  if (!thread_.take(std::move(request), done))
    done({.problem = "too many requests for curves wait; nothing was read; try again"});
}

RecordedCurves::Answer RecordedCurves::answer(const gateway::CurvesRequest& request) const {
  try {
    return read_curves(request);
  } catch (const std::exception& error) {
    return {.problem = error.what()};
  }
}

RecordedCurves::Answer RecordedCurves::read_curves(const gateway::CurvesRequest& request) const {
  const recording::Reader& reader = *recordings_.at(request.recording).reader;
  const std::vector<std::string> recorded = session::recorded_names(reader);
  std::vector<std::string> names;
  Answer answer;
  for (const std::string& name : request.names) {
    const bool is_recorded = std::ranges::find(recorded, name) != recorded.end();
    std::vector<std::string>& kind = is_recorded ? names : answer.unknown;
    if (std::ranges::find(kind, name) == kind.end()) kind.push_back(name);
  }
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
