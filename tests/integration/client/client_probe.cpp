// SPDX-License-Identifier: Apache-2.0
// A controller that prints the library's results, a line each, for tests that stop it, kill it and start it twice.
//
//   client_probe SESSION DOMAIN NAME CHANNEL STEP_TIME_OUT acquire|take_over
//
// With take_over it stops itself (SIGSTOP) when it has been refused, and takes the channel over when it goes on.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "client/slewring_client.h"

namespace {

constexpr double kSoon = 20;      // s
constexpr double kStick = 0.375;  // value of every answer

void print_line(const char* what, const char* text = "") {
  std::printf("%s%s\n", what, text);
  std::fflush(stdout);
}

// the channel's handle, or below zero
int take(slewring_session* session, const char* channel) {
  const int handle = slewring_acquire(session, channel, kSoon);
  if (handle < 0) {
    print_line("refused: ", slewring_error(session));
  } else {
    print_line("acquired");
  }
  return handle;
}

int take_over(slewring_session* session, const char* channel) {
  std::raise(SIGSTOP);
  const int handle = slewring_take_over(session, channel, kSoon);
  if (handle < 0) {
    print_line("not taken over: ", slewring_error(session));
  } else {
    print_line("taken over");
  }
  return handle;
}

void follow(slewring_session* session, const char* name, double timeout, bool may_take_over) {
  int channel = take(session, name);
  if (channel < 0 && may_take_over) channel = take_over(session, name);
  while (channel >= 0) {
    switch (slewring_step(session, timeout)) {
      case SLEWRING_OK:
        slewring_write(session, channel, kStick);
        break;
      case SLEWRING_TIMEOUT:
        print_line("timeout: ", slewring_error(session));
        break;
      case SLEWRING_LOST:
        print_line("lost: ", slewring_error(session));
        channel = take(session, name);
        break;
      default:
        print_line("ended: ", slewring_error(session));
        channel = -1;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  slewring_session* session =
      slewring_join(argv[1], argv[3], static_cast<unsigned>(std::atoi(argv[2])), "lo", "", kSoon);
  if (session == nullptr) {
    print_line("not joined: ", slewring_error(nullptr));
    return 1;
  }
  follow(session, argv[4], std::atof(argv[5]), std::strcmp(argv[6], "take_over") == 0);
  slewring_leave(session);
  return 0;
}
