// SPDX-License-Identifier: Apache-2.0
/* In the place of Simulink's own end of an S-function: gives the test its functions. */
const StubBlock stub_block = {mdlInitializeSizes, mdlInitializeSampleTimes, mdlStart, mdlOutputs, mdlUpdate,
                              mdlTerminate};
