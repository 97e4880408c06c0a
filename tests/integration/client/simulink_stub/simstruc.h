// SPDX-License-Identifier: Apache-2.0
/* As much of Simulink's C interface as examples/simulink/slewring_sfun.c uses: a block is a plain struct, which the
 * test fills and looks into. */
#ifndef SIMULINK_STUB_SIMSTRUC_H
#define SIMULINK_STUB_SIMSTRUC_H

#ifdef __cplusplus
extern "C" {
#endif

typedef double real_T;
typedef int int_T;

enum { STUB_PARAMETERS = 8, STUB_WIDTH = 8 };

/* a text, or a number where that is NULL */
typedef struct {
  const char* text;
  double number;
} mxArray;

typedef struct {
  mxArray parameters[STUB_PARAMETERS];
  int given, wanted; /* numbers of parameters */
  int inputs, outputs, handles;
  real_T u[STUB_WIDTH], y[STUB_WIDTH];
  int iwork[STUB_WIDTH];
  void* pwork;
  double period;
  int is_stop_requested;
  const char* error; /* NULL: none */
} SimStruct;

int mxGetString(const mxArray* value, char* text, int size);
double mxGetScalar(const mxArray* value);

#define SS_OPTION_CALL_TERMINATE_ON_EXIT 1
#define ssGetSFcnParam(S, i) (&(S)->parameters[i])
#define ssSetNumSFcnParams(S, n) ((S)->wanted = (n))
#define ssGetNumSFcnParams(S) ((S)->wanted)
#define ssGetSFcnParamsCount(S) ((S)->given)
#define ssSetNumOutputPorts(S, n) ((n) == 1)
#define ssSetNumInputPorts(S, n) ((n) == 1)
#define ssSetOutputPortWidth(S, port, n) ((S)->outputs = (n))
#define ssGetOutputPortWidth(S, port) ((S)->outputs)
#define ssSetInputPortWidth(S, port, n) ((S)->inputs = (n))
#define ssGetInputPortWidth(S, port) ((S)->inputs)
#define ssSetInputPortRequiredContiguous(S, port, yes) ((void)(yes))
#define ssSetInputPortDirectFeedThrough(S, port, yes) ((void)(yes))
#define ssSetNumSampleTimes(S, n) ((void)(n))
#define ssSetNumPWork(S, n) ((void)(n))
#define ssSetNumIWork(S, n) ((S)->handles = (n))
#define ssSetOptions(S, options) ((void)(options))
#define ssSetSampleTime(S, i, seconds) ((S)->period = (seconds))
#define ssSetOffsetTime(S, i, seconds) ((void)(seconds))
#define ssSetPWorkValue(S, i, value) ((S)->pwork = (value))
#define ssGetPWorkValue(S, i) ((S)->pwork)
#define ssSetIWorkValue(S, i, value) ((S)->iwork[i] = (value))
#define ssGetIWorkValue(S, i) ((S)->iwork[i])
#define ssGetInputPortRealSignal(S, port) ((S)->u)
#define ssGetOutputPortRealSignal(S, port) ((S)->y)
#define ssSetStopRequested(S, yes) ((S)->is_stop_requested = (yes))
#define ssSetErrorStatus(S, words) ((S)->error = (words))

/* what Simulink calls, in its order */
typedef struct {
  void (*sizes)(SimStruct*);
  void (*sample_times)(SimStruct*);
  void (*start)(SimStruct*);
  void (*outputs)(SimStruct*, int_T);
  void (*update)(SimStruct*, int_T);
  void (*terminate)(SimStruct*);
} StubBlock;
extern const StubBlock stub_block;

#ifdef __cplusplus
}
#endif

#endif
