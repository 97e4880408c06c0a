// Many independent computations, each in a process of this program, several at once; what is done stays in a folder and
// is not done again.
//
// A task is a command line of this program. Its process writes one JSON value with write_result() to the file that
// `--result` names; the file is there as a whole or not at all, so that a sweep may be ended at any moment and goes on
// where it was. The key of a task stands for all that its result follows from. A process that ends without a result
// leaves none: it is told, and tried again next time.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"

namespace slew::analysis {

struct SweepTask {
  std::string key;                     // letters, digits, '-', '_': name of its result's file
  std::string label;                   // told while it runs
  std::vector<std::string> arguments;  // of this program; `--result FILE` is added
  double weight = 1;                   // expected work beside the others'
};

struct SweepOptions {
  std::string folder;    // made when it is not there
  int workers = 2;       // processes at once
  bool is_anew = false;  // results that are there already are not taken
  std::string program;   // empty: this one
};

struct SweepResult {
  bool is_done = false;   // there is a value or a failure; false: the sweep ended before
  bool was_kept = false;  // from an earlier sweep
  Json value;             // null after a failure
  std::string failure;    // why there is no value; empty: there is one
};

// How far it is: what runs now, and the share of the weights that is done. False ends the sweep; what runs is given up.
struct SweepState {
  std::string doing;
  double share = 0;
  std::size_t done = 0, all = 0;
};
using SweepProgress = std::function<bool(const SweepState&)>;

// Results in the order of the tasks. Throws Failure (storage) when the folder cannot be made or written.
[[nodiscard]] std::vector<SweepResult> run_sweep(std::span<const SweepTask> tasks, const SweepOptions& options,
                                                 const SweepProgress& progress);

// Where a task's result lies.
[[nodiscard]] std::string result_file(const std::string& folder, const std::string& key);

// For the process of a task. Throws Failure (storage).
void write_result(const std::string& file, const Json& value);

// A key from all texts that a result follows from: 16 hexadecimal digits.
[[nodiscard]] std::string key_of(std::span<const std::string> texts);

}  // namespace slew::analysis
