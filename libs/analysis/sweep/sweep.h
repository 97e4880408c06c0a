// SPDX-License-Identifier: Apache-2.0
// Many independent computations, each in a process of this program, several at once; results stay in a folder and are
// not computed again.
//
// A task is a command line of this program. Its process writes one JSON value with write_result() to the file that
// `--result` names; the file is complete or missing, so that a sweep may be ended at any moment and continues later.
// The key of a task stands for all that its result depends on. A process that ends without a result is reported, and
// its task is tried again next time.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "scene/scene.h"

namespace slew::analysis {

struct SweepTask {
  std::string key;                     // letters, digits, '-', '_': name of its result's file
  std::string label;                   // shown while it runs
  std::vector<std::string> arguments;  // arguments of this program; `--result FILE` is added
  double weight = 1;                   // expected work relative to the others'
};

constexpr int kMostWorkers = 64;
constexpr int kMostParts = 1000;  // of a batch; Slurm's own limit of a job array is 1001

// Where tasks run: processes of this machine, or a batch (batch.h).
enum class Engine { local, slurm, mpi };

struct SweepOptions {
  std::string folder;  // made when it is missing
  int workers = 2;     // processes at once
  Engine engine = Engine::local;
  bool is_fresh = false;  // ignores the results of earlier sweeps
  std::string program;    // empty: this one
};

struct SweepResult {
  bool is_done = false;   // there is a value or a failure; false: the sweep ended before
  bool was_kept = false;  // from an earlier sweep
  Json value;             // null after a failure
  std::string failure;    // why there is no value; empty: there is one
};

// Progress: the running tasks, and the share of the weights that is done. False ends the sweep and the running tasks.
struct SweepState {
  std::string doing;
  double share = 0;
  std::size_t done = 0, all = 0;
};
using SweepProgress = std::function<bool(const SweepState&)>;

// Results in the order of the tasks. Throws Failure (storage) when the folder cannot be made or written.
[[nodiscard]] std::vector<SweepResult> run_sweep(std::span<const SweepTask> tasks, const SweepOptions& options,
                                                 const SweepProgress& progress);

// File of a task's result.
[[nodiscard]] std::string result_file(const std::string& folder, const std::string& key);

// None: there is no such file, or it is no JSON.
[[nodiscard]] std::optional<Json> read_result(const std::string& file);

// Called by the process of a task. Throws Failure (storage).
void write_result(const std::string& file, const Json& value);

// Everything in a scene that a result depends on, for its key: its text, and the digests of its files.
[[nodiscard]] std::string result_text(const scene::Scene& scene);

// A key from all texts that a result depends on: 16 hexadecimal digits.
[[nodiscard]] std::string key_of(std::span<const std::string> texts);

}  // namespace slew::analysis
