// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/instant.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "scene/units.h"

namespace slew::analysis {

using wire::Role;

double read_option(const std::string& option, const std::string& text, Dimension dimension) {
  scene::UnitSystem units;
  const scene::QuantityResult read = scene::read_quantity(text, scene::Writing::plain, dimension, units);
  if (read.value) return *read.value;
  throw Failure(ExitCode::bad_input, fmt::format("{}: {}", option, read.problem.text()));
}

void play_to(PlayedScene& played, double at) {
  while (played.time().ns < duration_of_seconds(at).ns) {
    played.advance();
    if (const std::string failure = played.session().failure(); !failure.empty()) {
      throw Failure(ExitCode::diverged,
                    fmt::format("the run ended at {} s, before {} s: {}", played.time().seconds(), at, failure));
    }
  }
}

const mechanics_node::MechanicsSubsystem* mechanics_of(const PlayedScene& played) {
  return played.session().physics<mechanics_node::MechanicsSubsystem>(Role::mechanics);
}

const hydraulics_node::HydraulicsSubsystem* hydraulics_of(const PlayedScene& played) {
  return played.session().physics<hydraulics_node::HydraulicsSubsystem>(Role::hydraulics);
}

}  // namespace slew::analysis
