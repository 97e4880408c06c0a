// SPDX-License-Identifier: Apache-2.0
// The tasks of a sweep on the machines of a cluster: files in, files out, by Slurm or an MPI launcher.
//
// The folder of the results lies where all machines see it, and receives batch.json with the tasks that have no result.
// Slurm runs a job array (`sbatch --array`), MPI as many ranks (`mpirun -n`), of `slewring sweep-part batch.json`. Part
// k of n is read from the environment of either and runs the tasks k, k + n, ... one after another, each in a process
// of its own. A task that ends without a result leaves KEY.failed with the reason. The program is not linked with MPI
// and sends no message: the launcher starts and ends its ranks, nothing else.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/sweep/sweep.h"

namespace slew::analysis {

// As run_sweep(), for an engine other than local. Throws Failure: resources when the engine cannot be started, failed
// when it ends with an error and leaves tasks without a result.
[[nodiscard]] std::vector<SweepResult> run_batch(std::span<const SweepTask> tasks, const SweepOptions& options,
                                                 const SweepProgress& progress);

// The process of one part. Throws Failure (bad_input) without a batch, or outside of an engine.
void run_batch_part(const std::string& batch_file);

}  // namespace slew::analysis
