// SPDX-License-Identifier: Apache-2.0
// A PID controller on one input of a running session: the integral stops at the stick's ends, the derivative is of the
// measured value and filtered. Its sample time is the time between two blocks of variables, from the session.
//
//   pid_controller --session crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86 --kp 60 --ki 40
#include <slewring_client.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "options.h"

namespace {

constexpr char kUsage[] =
    "usage: pid_controller --session NAME [--variable Cyl_Lift.stroke] [--channel Input_Lift] [--target 0.86]\n"
    "         [--kp 60] [--ki 40] [--kd 2] [--filter 0.02] [--overlap 0.32] [--tolerance 0.001] [--seconds 15]\n"
    "         [--name pid] [--domain 0] [--interface lo] [--peers ADDRESS,ADDRESS]\n"
    "--seconds is time of the session; the program waits during a pause; Ctrl-C ends it. Example, with `slewring run "
    "scenes/truck_crane.yaml --input none --duration 0`\n"
    "in another terminal:\n"
    "  pid_controller --session truck_crane --target 0.86 --kp 60 --ki 40\n";

struct Pid {
  double kp = 60, ki = 40, kd = 2;  // stick per unit of error, per unit and second, per unit a second
  double filter = 0.02;             // s, time constant of the derivative

  // u = kp e + I - kd dy/dt, I = ki * integral of e while u is inside -1 .. 1
  double update(double target, double value, double dt) {
    const double error = target - value;
    if (dt > 0) rate_ += (dt / (filter + dt)) * ((value - last_) / dt - rate_);
    last_ = value;
    const double wanted = kp * error + integral_ + ki * error * dt - kd * rate_;
    const bool drives_further = std::fabs(wanted) > 1 && wanted * error > 0;
    if (!drives_further) integral_ += ki * error * dt;
    return std::clamp(kp * error + integral_ - kd * rate_, -1.0, 1.0);
  }

 private:
  double integral_ = 0, rate_ = 0, last_ = 0;
};

// the valve does nothing below this stick value: the controller's output begins beyond it
double over_the_overlap(double u, double overlap, double rest) {
  return std::fabs(u) < rest ? 0 : std::copysign(overlap + (1 - overlap) * std::fabs(u), u);
}

volatile std::sig_atomic_t is_stopped = 0;  // by Ctrl-C: the channel is given back

// Next block; false when the session has ended, or this program is to end.
bool next_block(slewring::Session& session) {
  while (is_stopped == 0) {
    try {
      return session.step(1);
    } catch (const slewring::Error& error) {
      if (error.code() != SLEWRING_TIMEOUT) throw;  // a timeout is a pause
    }
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  SessionOptions options;
  options.name = "pid";
  Pid pid;
  std::string variable_name = "Cyl_Lift.stroke", channel_name = "Input_Lift";
  double target = 0.86, overlap = 0.32, tolerance = 1e-3;
  std::vector<Option> known = {{"--variable", nullptr, &variable_name},
                               {"--channel", nullptr, &channel_name},
                               {"--target", &target, nullptr},
                               {"--kp", &pid.kp, nullptr},
                               {"--ki", &pid.ki, nullptr},
                               {"--kd", &pid.kd, nullptr},
                               {"--filter", &pid.filter, nullptr},
                               {"--overlap", &overlap, nullptr},
                               {"--tolerance", &tolerance, nullptr}};
  options.add_to(known);
  if (const int problem = parse("pid_controller", argc, argv, known, kUsage); problem != 0)
    return problem == 1 ? 0 : problem;
  if (const int problem = options.check("pid_controller", kUsage); problem != 0) return problem;
  try {
    slewring::Options join;
    join.session = options.session;
    join.controller = options.name;
    join.domain = static_cast<unsigned>(options.domain);
    join.interface_name = options.interface_name;
    join.peers = options.peers;
    slewring::Session session(join);
    const slewring::Variable variable = session.find(variable_name);
    const slewring::Channel channel = session.acquire(channel_name);

    double begin = -1, last = 0, worst = 0;
    std::signal(SIGINT, [](int) { is_stopped = 1; });
    while (next_block(session)) {
      const double now = session.time();
      if (begin < 0) begin = last = now;
      if (now - begin > options.seconds) break;
      const double value = session.value(variable);
      const double u = pid.update(target, value, now - last);
      session.write(channel, over_the_overlap(u, overlap, 0.5 * pid.kp * tolerance));
      last = now;
      // the largest error of the last second
      worst = now - begin < options.seconds - 1 ? 0 : std::max(worst, std::fabs(target - value));
    }
    const bool is_there = last - begin > options.seconds - 1 && worst < tolerance;
    std::printf("%s = %.5f after %.2f s, target %.5f, error of the last second %.5f: %s\n", variable_name.c_str(),
                session.value(variable), last - begin, target, worst, is_there ? "reached" : "not reached");
    return is_there ? 0 : 1;
  } catch (const slewring::Error& error) {
    std::fprintf(stderr, "pid_controller: %s\n", error.what());
    return 1;
  }
}
