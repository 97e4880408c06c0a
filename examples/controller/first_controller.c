// SPDX-License-Identifier: Apache-2.0
/* The shortest controller, in C: half a stick for two seconds of the session.   first_controller SESSION [DOMAIN]
 * A session that is paused is waited for; Ctrl-C ends it, and gives the channel back. */
#include <signal.h>
#include <slewring_client.h>
#include <stdio.h>
#include <stdlib.h>

static volatile sig_atomic_t is_stopped = 0;

static void stop(int signal) {
  (void)signal;
  is_stopped = 1;
}

int main(int argc, char** argv) {
  const char* name = argc > 1 ? argv[1] : "truck_crane";
  slewring_session* session = slewring_join(name, "first", argc > 2 ? (unsigned)atoi(argv[2]) : 0, "lo", "", 10);
  int stroke = slewring_find(session, "Cyl_Lift.stroke", 5);
  int lift = slewring_acquire(session, "Input_Lift", 5);
  double begin = -1;
  int code = SLEWRING_OK;
  if (lift < 0 || stroke < 0) {
    fprintf(stderr, "first_controller: %s\n", slewring_error(session));
    slewring_leave(session);
    return 1;
  }
  signal(SIGINT, stop);
  while (!is_stopped) {
    code = slewring_step(session, 1);
    if (code == SLEWRING_TIMEOUT) continue; /* a pause */
    if (code != SLEWRING_OK) break;
    if (begin < 0) begin = slewring_time(session);
    if (slewring_time(session) > begin + 2) break;
    slewring_write(session, lift, 0.5);
  }
  if (code == SLEWRING_LOST || code == SLEWRING_FAILED) {
    fprintf(stderr, "first_controller: %s\n", slewring_error(session));
  }
  printf("Cyl_Lift.stroke = %.5f at %.2f s\n", slewring_value(session, stroke), slewring_time(session));
  slewring_leave(session);
  return 0;
}
