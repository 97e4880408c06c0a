/* The shortest controller, in C: half a stick for two seconds of the session.   first_controller SESSION [DOMAIN] */
#include <slewring_client.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  const char* name = argc > 1 ? argv[1] : "truck_crane";
  slewring_session* session = slewring_join(name, "first", argc > 2 ? (unsigned)atoi(argv[2]) : 0, "lo", "", 10);
  int stroke = slewring_find(session, "Cyl_Lift.stroke", 5);
  int lift = slewring_acquire(session, "Input_Lift", 5);
  double begin = -1;
  if (lift < 0 || stroke < 0) {
    fprintf(stderr, "first_controller: %s\n", slewring_error(session));
    slewring_leave(session);
    return 1;
  }
  while (slewring_step(session, 1) == SLEWRING_OK) {
    if (begin < 0) begin = slewring_time(session);
    if (slewring_time(session) > begin + 2) break;
    slewring_write(session, lift, 0.5);
  }
  printf("Cyl_Lift.stroke = %.5f at %.2f s\n", slewring_value(session, stroke), slewring_time(session));
  slewring_leave(session);
  return 0;
}
