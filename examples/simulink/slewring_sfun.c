// SPDX-License-Identifier: Apache-2.0
/* A Simulink block that is a controller's end of a Slewring session: its outputs are variables of the session at the
 * present block, its inputs go to input channels as computed from that block. One major step is one block of variables,
 * in order, so that a lockstep channel is served; the model waits for the session, which is its clock.
 *
 * Parameters of the block, in this order:
 *   session     'truck_crane'
 *   controller  'simulink'
 *   domain      0
 *   variables   'Cyl_Lift.stroke,Cyl_Lift.force'   one output element each
 *   channels    'Input_Lift'                       one input element each
 *   period      0.01                               session.step x recording.every [s]; another one ends the model
 *   interface   'lo'                               network interface of the session
 *   peers       ''                                 other machines' addresses with commas, for a session beyond this one
 *
 * Keys for a session that has them are in the environment of MATLAB: SLEWRING_KEYS=DIR, SLEWRING_IDENTITY=NAME.
 *
 * Build:  mex slewring_sfun.c -IPREFIX/include -LPREFIX/lib -lslewring_client
 * Model:  fixed-step solver with the same period; the inputs have no direct feed-through: the session's values
 * in a step do not depend on the model's values in that step. */
#define S_FUNCTION_NAME slewring_sfun
#define S_FUNCTION_LEVEL 2

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "simstruc.h"
#include "slewring_client.h"

#define MAX_NAMES 64
#define MAX_TEXT 4096
#define TIMEOUT 10.0   /* s */
#define PAUSE_WAITS 60 /* as often for a block: a session may be paused for ten minutes */
#define SEEN_BLOCKS 5  /* from then on their distance is known, also when one was lost */

enum { SESSION, CONTROLLER, DOMAIN, VARIABLES, CHANNELS, PERIOD, INTERFACE, PEERS, PARAMETERS };

/* number of names in a list with commas; each name is cut off in place, and no more than MAX_NAMES are kept */
static int split(char* list, char* names[MAX_NAMES]) {
  int count = 0;
  char* name = strtok(list, ",");
  for (; name != NULL; name = strtok(NULL, ",")) {
    if (count < MAX_NAMES) names[count] = name;
    ++count;
  }
  return count;
}

static void read_text(SimStruct* S, int parameter, char text[MAX_TEXT]) {
  text[0] = '\0';
  mxGetString(ssGetSFcnParam(S, parameter), text, MAX_TEXT);
}

/* number of names; -1, and the simulation ends, when there are more than are kept */
static int read_list(SimStruct* S, int parameter, char text[MAX_TEXT], char* names[MAX_NAMES]) {
  static char problem[256];
  int count, is_cut;
  read_text(S, parameter, text);
  is_cut = strlen(text) >= MAX_TEXT - 1;
  count = split(text, names);
  if (count <= MAX_NAMES && !is_cut) return count;
  snprintf(problem, sizeof problem,
           "slewring_sfun: parameter %d has too many names: at most %d, %d characters; use a "
           "second block with a controller name of its own",
           parameter + 1, MAX_NAMES, MAX_TEXT - 2);
  ssSetErrorStatus(S, problem);
  return -1;
}

/* 0, and the simulation ends, when the model's time is not the session's */
static int has_the_period(SimStruct* S, slewring_session* session) {
  static char problem[256];
  const double period = mxGetScalar(ssGetSFcnParam(S, PERIOD));
  const double blocks = slewring_step_size(session) * slewring_steps_per_block(session);
  if (fabs(blocks - period) <= 1e-6 * blocks) return 1;
  snprintf(problem, sizeof problem,
           "slewring_sfun: the period is %g s, and the session has a block of variables every "
           "%g s (session.step times recording.every); give the block and the solver that period",
           period, blocks);
  ssSetErrorStatus(S, problem);
  return 0;
}

/* the sentence of the library ends the simulation */
static void fail(SimStruct* S, slewring_session* session) {
  static char text[1024];
  snprintf(text, sizeof text, "%s", slewring_error(session));
  ssSetErrorStatus(S, text);
}

static void mdlInitializeSizes(SimStruct* S) {
  static char text[MAX_TEXT];
  char* names[MAX_NAMES];
  int variables, channels;
  ssSetNumSFcnParams(S, PARAMETERS);
  if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) return;
  variables = read_list(S, VARIABLES, text, names);
  channels = read_list(S, CHANNELS, text, names);
  if (variables < 0 || channels < 0) return;
  if (!ssSetNumOutputPorts(S, 1) || !ssSetNumInputPorts(S, 1)) return;
  ssSetOutputPortWidth(S, 0, variables);
  ssSetInputPortWidth(S, 0, channels);
  ssSetInputPortRequiredContiguous(S, 0, 1);
  ssSetInputPortDirectFeedThrough(S, 0, 0);
  ssSetNumSampleTimes(S, 1);
  ssSetNumPWork(S, 1);                        /* the session */
  ssSetNumIWork(S, variables + channels + 1); /* its handles, and how many blocks have come, up to SEEN_BLOCKS */
  ssSetOptions(S, SS_OPTION_CALL_TERMINATE_ON_EXIT);
}

static void mdlInitializeSampleTimes(SimStruct* S) {
  ssSetSampleTime(S, 0, mxGetScalar(ssGetSFcnParam(S, PERIOD)));
  ssSetOffsetTime(S, 0, 0.0);
}

#define MDL_START
static void mdlStart(SimStruct* S) {
  static char text[MAX_TEXT], name[MAX_TEXT], controller[MAX_TEXT], interface[MAX_TEXT], peers[MAX_TEXT];
  char* names[MAX_NAMES];
  slewring_session* session;
  int i, count, handle, next = 0;
  read_text(S, SESSION, name);
  read_text(S, CONTROLLER, controller);
  read_text(S, INTERFACE, interface);
  read_text(S, PEERS, peers);
  session =
      slewring_join(name, controller, (unsigned)mxGetScalar(ssGetSFcnParam(S, DOMAIN)), interface, peers, TIMEOUT);
  ssSetPWorkValue(S, 0, session);
  if (session == NULL) {
    fail(S, NULL);
    return;
  }
  count = read_list(S, VARIABLES, text, names);
  for (i = 0; i < count; ++i) {
    handle = slewring_find(session, names[i], TIMEOUT);
    if (handle < 0) {
      fail(S, session);
      return;
    }
    ssSetIWorkValue(S, next++, handle);
  }
  count = read_list(S, CHANNELS, text, names);
  for (i = 0; i < count; ++i) {
    handle = slewring_acquire(session, names[i], TIMEOUT);
    if (handle < 0) {
      fail(S, session);
      return;
    }
    ssSetIWorkValue(S, next++, handle);
  }
  ssSetIWorkValue(S, next, 0);
}

/* waits for the next block; `slewring control stop` ends a session that is paused, and the model with it */
static void mdlOutputs(SimStruct* S, int_T task) {
  slewring_session* session = (slewring_session*)ssGetPWorkValue(S, 0);
  real_T* y = ssGetOutputPortRealSignal(S, 0);
  const int width = ssGetOutputPortWidth(S, 0), seen = width + ssGetInputPortWidth(S, 0);
  int i, code = slewring_step(session, TIMEOUT);
  (void)task;
  for (i = 1; code == SLEWRING_TIMEOUT && i < PAUSE_WAITS; ++i) code = slewring_step(session, TIMEOUT);
  if (code == SLEWRING_ENDED) {
    ssSetStopRequested(S, 1);
    return;
  }
  if (code != SLEWRING_OK) {
    fail(S, session);
    return;
  }
  if (ssGetIWorkValue(S, seen) < SEEN_BLOCKS) {
    ssSetIWorkValue(S, seen, ssGetIWorkValue(S, seen) + 1);
    if (ssGetIWorkValue(S, seen) == SEEN_BLOCKS && !has_the_period(S, session)) return;
  }
  for (i = 0; i < width; ++i) y[i] = slewring_value(session, ssGetIWorkValue(S, i));
}

/* answers it */
#define MDL_UPDATE
static void mdlUpdate(SimStruct* S, int_T task) {
  slewring_session* session = (slewring_session*)ssGetPWorkValue(S, 0);
  const real_T* u = ssGetInputPortRealSignal(S, 0);
  const int first = ssGetOutputPortWidth(S, 0), width = ssGetInputPortWidth(S, 0);
  int i;
  (void)task;
  for (i = 0; i < width; ++i) {
    if (slewring_write(session, ssGetIWorkValue(S, first + i), u[i]) != SLEWRING_OK) fail(S, session);
  }
}

static void mdlTerminate(SimStruct* S) {
  slewring_leave((slewring_session*)ssGetPWorkValue(S, 0));
  ssSetPWorkValue(S, 0, NULL);
}

#ifdef MATLAB_MEX_FILE
#include "simulink.c"
#else
#include "cg_sfun.h"
#endif
