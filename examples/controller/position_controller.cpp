// SPDX-License-Identifier: Apache-2.0
// Closes a position loop on a cylinder of a running session, from outside: it reads a variable and moves one input.
// A lockstep channel needs no other code than a sampled one. examples/controller_dds is the same without the library.
//
//   position_controller --session crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86
#include <slewring_client.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "options.h"

namespace {

constexpr char kUsage[] =
    "usage: position_controller --session NAME [--variable Cyl_Lift.stroke] [--channel Input_Lift]\n"
    "         [--target 0.86] [--tolerance 0.001] [--gain 20] [--overlap 0.32] [--seconds 15] [--take-over yes]\n"
    "         [--name position_controller] [--domain 0] [--interface lo] [--peers ADDRESS,ADDRESS]\n"
    "Example, with `slewring run scenes/truck_crane.yaml --input none --duration 0` in another terminal:\n"
    "  position_controller --session truck_crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86\n";

constexpr int kSteady = 100;  // values in a row within the tolerance

struct Loop {
  std::string variable = "Cyl_Lift.stroke";
  std::string channel = "Input_Lift";
  std::string take_over = "no";  // yes: takes the channel from its holder, which only the channel's supervisor may
  double target = 0.86;          // unit of the variable
  double tolerance = 1e-3;       // unit of the variable
  double gain = 20;              // stick per unit of error
  double overlap = 0.32;         // the valve does nothing below this stick value

  // proportional, with a jump over the valve's overlap and a rest within half the tolerance
  double stick(double value) const {
    const double error = target - value;
    if (std::fabs(error) < 0.5 * tolerance) return 0;
    const double share = std::min(1.0, std::fabs(gain * error));
    return std::copysign(overlap + (1 - overlap) * share, error);
  }
};

slewring::Channel take(slewring::Session& session, const Loop& loop) {
  return loop.take_over == "yes" ? session.take_over(loop.channel) : session.acquire(loop.channel);
}

// Whether the target was reached before the time was over or the session ended; prints the result.
bool run(const SessionOptions& options, const Loop& loop) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  slewring::Options join;
  join.session = options.session;
  join.controller = options.name;
  join.domain = static_cast<unsigned>(options.domain);
  join.interface_name = options.interface_name;
  join.peers = options.peers;
  join.timeout = options.seconds;
  slewring::Session session(join);
  const slewring::Variable variable = session.find(loop.variable);
  slewring::Channel channel = take(session, loop);

  int steady = 0;
  while (steady < kSteady && std::chrono::duration<double>(Clock::now() - begin).count() < options.seconds) {
    try {
      if (!session.step(1)) break;
      session.write(channel, loop.stick(session.value(variable)));
    } catch (const slewring::Error& error) {
      if (error.code() == SLEWRING_TIMEOUT) continue;  // a pause
      if (error.code() != SLEWRING_LOST) throw;
      std::fprintf(stderr, "position_controller: %s\n", error.what());
      channel = take(session, loop);
      continue;
    }
    steady = std::fabs(loop.target - session.value(variable)) < loop.tolerance ? steady + 1 : 0;
    while (const auto notice = session.notice()) std::fprintf(stderr, "position_controller: %s\n", notice->c_str());
  }
  std::printf("%s = %.5f, target %.5f: %s\n", loop.variable.c_str(), session.value(variable), loop.target,
              steady >= kSteady ? "reached" : "not reached");
  return steady >= kSteady;
}

}  // namespace

int main(int argc, char** argv) {
  SessionOptions options;
  options.name = "position_controller";
  Loop loop;
  std::vector<Option> known = {{"--variable", nullptr, &loop.variable},   {"--channel", nullptr, &loop.channel},
                               {"--take-over", nullptr, &loop.take_over}, {"--target", &loop.target, nullptr},
                               {"--tolerance", &loop.tolerance, nullptr}, {"--gain", &loop.gain, nullptr},
                               {"--overlap", &loop.overlap, nullptr}};
  options.add_to(known);
  if (const int problem = parse("position_controller", argc, argv, known, kUsage); problem != 0)
    return problem == 1 ? 0 : problem;
  if (const int problem = options.check("position_controller", kUsage); problem != 0) return problem;
  try {
    return run(options, loop) ? 0 : 1;
  } catch (const slewring::Error& error) {
    std::fprintf(stderr, "position_controller: %s%s\n", error.code() == SLEWRING_REFUSED ? "refused: " : "",
                 error.what());
    return 1;
  }
}
