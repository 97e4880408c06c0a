// SPDX-License-Identifier: Apache-2.0
/* A position loop on LCM, in C, on the code that lcm-gen generates: crane_t comes in, input_t goes out.
 *   lift_controller SESSION TARGET SECONDS
 * Ends when the stroke has been within 2 mm of the target for half a second of the session, with 0, or after SECONDS of
 * the session without that, with 1. */
#include <lcm/lcm.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "slewring_crane_t.h"
#include "slewring_input_t.h"

typedef struct {
  char input_channel[64];
  slewring_input_t input;
  double target, seconds;
  double begin, near_since; /* s in the session, -1: not yet */
  int64_t last_step, least_distance, late;
  int result; /* -1: goes on */
} controller;

/* The valve passes no oil below 32 % of the stick: proportional with a jump over that, at rest within 1 mm. */
static double stick(double error) {
  return fabs(error) < 1e-3 ? 0 : copysign(0.32 + 0.68 * fmin(1, fabs(20 * error)), error);
}

static void take_crane(const lcm_recv_buf_t* buffer, const char* channel, const slewring_crane_t* crane, void* user) {
  controller* c = user;
  double error = c->target - crane->Cyl_Lift_stroke;
  int64_t distance = crane->step - c->last_step;
  (void)channel;
  /* LCM repeats nothing: a larger distance of two steps is a lost message */
  if (c->last_step >= 0 && distance > 0) {
    if (c->least_distance == 0 || distance < c->least_distance) c->least_distance = distance;
    if (distance > c->least_distance) ++c->late;
  }
  c->last_step = crane->step;
  if (c->begin < 0) c->begin = crane->time;
  if (fabs(error) > 2e-3) c->near_since = -1;
  else if (c->near_since < 0) c->near_since = crane->time;
  c->input.sequence += 1;
  c->input.value = stick(error);
  c->input.based_on_step = crane->step;
  slewring_input_t_publish(buffer->lcm, c->input_channel, &c->input);
  if (c->near_since >= 0 && crane->time > c->near_since + 0.5) c->result = 0;
  else if (crane->time > c->begin + c->seconds) c->result = 1;
  if (c->result >= 0)
    printf("Cyl_Lift.stroke = %.5f, target %.5f: %s; %lld inputs, %lld messages lost on the way here\n",
           crane->Cyl_Lift_stroke, c->target, c->result == 0 ? "reached" : "not reached",
           (long long)c->input.sequence, (long long)c->late);
}

int main(int argc, char** argv) {
  controller c = {.begin = -1, .near_since = -1, .last_step = -1, .result = -1};
  char crane_channel[64];
  lcm_t* lcm = lcm_create("udpm://239.255.76.67:7667?ttl=0");
  if (argc != 4 || lcm == NULL) {
    fprintf(stderr, "lift_controller SESSION TARGET SECONDS; multicast must be routed to the loopback\n");
    return 2;
  }
  snprintf(crane_channel, sizeof crane_channel, "SLEWRING_%s_crane", argv[1]);
  snprintf(c.input_channel, sizeof c.input_channel, "SLEWRING_%s_INPUT", argv[1]);
  c.target = atof(argv[2]);
  c.seconds = atof(argv[3]);
  c.input.controller = "lift";
  c.input.channel = "Input_Lift";
  c.input.sender = (int64_t)time(NULL) * 65536 + getpid() % 65536; /* another process has another number */
  slewring_crane_t_subscribe(lcm, crane_channel, take_crane, &c);
  while (c.result < 0) {
    if (lcm_handle_timeout(lcm, 60000) <= 0) {
      fprintf(stderr, "lift_controller: no message on %s for 60 s\n", crane_channel);
      c.result = 1;
    }
  }
  lcm_destroy(lcm);
  return c.result;
}
