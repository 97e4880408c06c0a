// SPDX-License-Identifier: Apache-2.0
// Slewring's client library: read variables of a running session and move its inputs, from C or anything that calls C.
//
//   slewring_session* s = slewring_join("truck_crane", "pid", 0, "lo", "", 10);
//   int stroke = slewring_find(s, "Cyl_Lift.stroke", 5);
//   int lift = slewring_acquire(s, "Input_Lift", 5);
//   int code = SLEWRING_OK;
//   while (code == SLEWRING_OK || code == SLEWRING_TIMEOUT) {  // the latter is a pause
//     code = slewring_step(s, 1);
//     if (code == SLEWRING_OK) slewring_write(s, lift, 20 * (0.86 - slewring_value(s, stroke)));
//   }
//   slewring_leave(s);
//
// Order: join, find the variables, acquire the channels, then one round per step: wait, read, write. slewring_step()
// gives every block of variables in order, as a lockstep channel needs them; slewring_latest() gives the newest.
//
// A result below zero is a code; slewring_error() then has the sentence: what happened, what to do. Texts belong
// to the library and stay until the next call for the same session. Units are those of slewring_variable_unit(), SI.
// Time-outs are in seconds; 0 does not wait. A session's functions are for one thread at a time; several sessions may
// have a thread each. No signal handler is set, nothing is printed.
//
// Not covered: scene parameters, pause and reset (program `slewring param`, `slewring control`), sessions of another
// protocol version.
#ifndef SLEWRING_CLIENT_H
#define SLEWRING_CLIENT_H

#if defined(__GNUC__) && !defined(SLEWRING_NO_EXPORT)
#define SLEWRING_API __attribute__((visibility("default")))
#else
#define SLEWRING_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct slewring_session slewring_session;

enum {
  SLEWRING_OK = 0,
  SLEWRING_TIMEOUT = -1,       // no answer within the time
  SLEWRING_REFUSED = -2,       // the session rejected the request; the text has the reason
  SLEWRING_LOST = -3,          // a channel was taken away: acquire it again to go on
  SLEWRING_ENDED = -4,         // the session is over
  SLEWRING_BAD_ARGUMENT = -5,  // an invalid handle, text or number
  SLEWRING_FAILED = -6         // network or memory
};

// Joins a session by its name and waits until it is found. controller: own name, unique in the session. interface_name:
// network interface, NULL or "": "lo"; peers: addresses of other hosts, separated by commas, NULL or "": none.
// A session with keys needs SLEWRING_KEYS=DIR in the environment, and SLEWRING_IDENTITY=NAME when that is not
// "controller" (`slewring keys`); an interface that leaves this machine is refused without, unless
// SLEWRING_INSECURE_LAN=1 is there.
// NULL on failure; on the same thread slewring_error(NULL) then has the reason and slewring_join_code() the code:
// SLEWRING_TIMEOUT (no such session was found), SLEWRING_REFUSED (another protocol version), SLEWRING_BAD_ARGUMENT
// (names, domain, interface, keys) or SLEWRING_FAILED.
SLEWRING_API slewring_session* slewring_join(const char* session, const char* controller, unsigned domain,
                                             const char* interface_name, const char* peers, double timeout_s);
// Code of this thread's last slewring_join(); SLEWRING_OK when it gave a session, or there was none.
SLEWRING_API int slewring_join_code(void);
// Gives the channels back, a lockstep one after the ticks of the last value, and frees everything. NULL is allowed.
SLEWRING_API void slewring_leave(slewring_session* session);

// The reason of the last failure; "" when there was none.
SLEWRING_API const char* slewring_error(const slewring_session* session);

// Communication step H [s], and steps between two blocks of variables as they have come; 0: not known yet.
SLEWRING_API double slewring_step_size(const slewring_session* session);
SLEWRING_API int slewring_steps_per_block(const slewring_session* session);

// Variables that are known, by number from 0 on, in no particular order; NULL beyond the last.
SLEWRING_API int slewring_variable_count(slewring_session* session);
SLEWRING_API const char* slewring_variable_name(const slewring_session* session, int number);
SLEWRING_API const char* slewring_variable_unit(const slewring_session* session, int number);

// Handle of a variable that step() is to read, >= 0, or a code. Find all variables before the first step().
SLEWRING_API int slewring_find(slewring_session* session, const char* variable, double timeout_s);
// Value at the present step; NaN before the first step() and for an invalid handle.
SLEWRING_API double slewring_value(const slewring_session* session, int variable);

// Handle of a channel that this controller now holds, >= 0, or a code: SLEWRING_REFUSED when another one holds it.
SLEWRING_API int slewring_acquire(slewring_session* session, const char* channel, double timeout_s);
// The same for the channel's supervisor, which takes it from its holder.
SLEWRING_API int slewring_take_over(slewring_session* session, const char* channel, double timeout_s);
SLEWRING_API int slewring_release(slewring_session* session, int channel);

// Waits for the next block of all variables that were found; without any, for the next of the session's own. Time in
// which this process itself stood still does not count.
SLEWRING_API int slewring_step(slewring_session* session, double timeout_s);
// The same, but passes over all blocks that are older than the newest: for sampled channels and displays.
SLEWRING_API int slewring_latest(slewring_session* session, double timeout_s);
// Step of the present values, -1 before the first; its time in the session [s]; how many blocks of the epochs so far
// never came, as of the smallest distance of two blocks: this program was too slow for them, or they were lost.
SLEWRING_API long long slewring_present_step(const slewring_session* session);
SLEWRING_API double slewring_time(const slewring_session* session);
SLEWRING_API long long slewring_blocks_missed(const slewring_session* session);

// Value computed from the present step: -1 to 1, digital 0 or 1; the session limits a value outside to the bound.
SLEWRING_API int slewring_write(slewring_session* session, int channel, double value);

// Unrequested sentences from the session about this controller's channels (out of step, back in it, put to neutral),
// one a call; NULL: no new one.
SLEWRING_API const char* slewring_notice(slewring_session* session);

#ifdef __cplusplus
}
#endif

#endif
