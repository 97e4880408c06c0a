// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep/batch.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>

#include "core/child_process.h"
#include "core/failure.h"
#include "core/installation.h"
#include "core/text_output.h"
#include "core/time.h"

namespace slew::analysis {
namespace {

constexpr int kLookMs = 200;                            // between two looks at the results
constexpr std::int64_t kLauncherEndNs = 5'000'000'000;  // for an interrupted launcher to end its ranks
constexpr int kNotFound = 127;                          // exit code of env(1)

std::optional<std::string> read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::filesystem::path failure_file(const std::string& folder, const std::string& key) {
  return std::filesystem::path(folder) / (key + ".failed");
}

// for a command of the shell that Slurm runs
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

class Batch {
 public:
  Batch(std::span<const SweepTask> tasks, const SweepOptions& options, const SweepProgress& progress)
      : tasks_(tasks),
        options_(options),
        progress_(progress),
        folder_(std::filesystem::absolute(options.folder).string()),
        results_(tasks.size()) {}

  std::vector<SweepResult> run() {
    for (std::size_t i = 0; i < tasks_.size(); ++i) take_kept(i);
    if (std::any_of(results_.begin(), results_.end(), [](const SweepResult& result) { return !result.is_done; })) {
      write_batch();
      launch();
    }
    static_cast<void>(progress_(state()));
    return std::move(results_);
  }

 private:
  void take_kept(std::size_t task) {
    if (options_.is_fresh) return;
    std::optional<Json> value = read_result(result_file(folder_, tasks_[task].key));
    if (value) results_[task] = {.is_done = true, .was_kept = true, .value = std::move(*value), .failure = {}};
  }

  void write_batch() {
    Json tasks = Json::array();
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (results_[i].is_done) continue;
      std::error_code error;
      std::filesystem::remove(result_file(folder_, tasks_[i].key), error);
      std::filesystem::remove(failure_file(folder_, tasks_[i].key), error);
      tasks.push_back({{"key", tasks_[i].key}, {"label", tasks_[i].label}, {"arguments", tasks_[i].arguments}});
    }
    parts_ = std::min<std::size_t>(static_cast<std::size_t>(options_.workers), tasks.items().size());
    program_ = options_.program.empty() ? sibling_program("slewring") : options_.program;
    batch_file_ = (std::filesystem::path(folder_) / "batch.json").string();
    write_text(batch_file_, Json{{"program", program_}, {"tasks", tasks}}.dump());
  }

  [[nodiscard]] std::vector<std::string> launcher() const {
    if (options_.engine == Engine::mpi) {
      return {"mpirun", "-n", std::to_string(parts_), program_, "sweep-part", batch_file_};
    }
    const std::string log = (std::filesystem::path(folder_) / "slurm-%a.log").string();
    return {"sbatch",
            "--parsable",
            "--wait",
            fmt::format("--array=0-{}", parts_ - 1),
            "--job-name=slewring-sweep",
            "--output=" + log,
            "--wrap",
            "exec " + quoted(program_) + " sweep-part " + quoted(batch_file_)};
  }

  void launch() {
    const std::vector<std::string> arguments = launcher();
    // env(1) finds the program in PATH
    ChildProcess process(arguments.front(), "/usr/bin/env", arguments);
    bool is_wanted = true;
    while (!process.poll_end() && is_wanted) {
      pollfd pipe{process.output_fd(), POLLIN, 0};
      static_cast<void>(poll(&pipe, 1, kLookMs));
      take_lines(process);
      is_wanted = progress_(state());
    }
    if (!is_wanted) end(process);
    take_lines(process);
    for (std::size_t i = 0; i < tasks_.size(); ++i) take_result(i);
    if (is_wanted) require_end(process);
  }

  void take_lines(ChildProcess& process) {
    for (std::string& line : process.take_lines()) {
      if (first_line_.empty()) first_line_ = line;
      // mpirun frames its message in lines of dashes
      const bool has_words = std::any_of(line.begin(), line.end(), [](char c) { return c >= 'a' && c <= 'z'; });
      if (has_words && reason_.empty()) reason_ = std::move(line);
    }
  }

  // the first line of `sbatch --parsable` is "JOB" or "JOB;CLUSTER"
  void end(ChildProcess& process) const {
    if (options_.engine == Engine::slurm && !first_line_.empty()) {
      ChildProcess cancel("scancel", "/usr/bin/env", {"scancel", first_line_.substr(0, first_line_.find(';'))});
      wait_for(cancel);
    }
    process.send_signal(SIGTERM);
    wait_for(process);
  }

  static void wait_for(ChildProcess& process) {
    const std::int64_t limit = monotonic_ns() + kLauncherEndNs;
    while (!process.poll_end() && monotonic_ns() < limit) static_cast<void>(poll(nullptr, 0, kLookMs / 10));
  }

  void take_result(std::size_t task) {
    SweepResult& result = results_[task];
    if (result.is_done) return;
    std::optional<Json> value = read_result(result_file(folder_, tasks_[task].key));
    const std::optional<std::string> failure = read_text(failure_file(folder_, tasks_[task].key));
    result.is_done = value || failure;
    if (value) {
      result.value = std::move(*value);
    } else if (failure) {
      result.failure = *failure;
    }
  }

  void require_end(ChildProcess& process) const {
    const ProcessEnd& end = *process.poll_end();
    const bool is_complete =
        std::all_of(results_.begin(), results_.end(), [](const SweepResult& result) { return result.is_done; });
    if (is_complete) return;
    const std::string name = process.name();
    if (end.exit_code == kNotFound) {
      throw Failure(ExitCode::resources,
                    fmt::format("{0} was not found; nothing was run; install {1}, or use --engine local", name,
                                options_.engine == Engine::mpi ? "openmpi-bin" : "slurm-client"));
    }
    throw Failure(ExitCode::failed,
                  fmt::format("{} {} and left rows without a result{}{}; rows that are done are kept; see the logs in "
                              "{}, then give the same command again",
                              name, end.text(), reason_.empty() ? "" : ": ", reason_, folder_));
  }

  [[nodiscard]] SweepState state() const {
    SweepState state;
    state.all = tasks_.size();
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      const bool is_done = results_[i].is_done || std::filesystem::exists(result_file(folder_, tasks_[i].key)) ||
                           std::filesystem::exists(failure_file(folder_, tasks_[i].key));
      if (is_done) ++state.done;
    }
    state.share = state.all > 0 ? static_cast<double>(state.done) / static_cast<double>(state.all) : 1;
    state.doing = options_.engine == Engine::mpi ? "mpirun" : "Slurm job " + first_line_;
    return state;
  }

  std::span<const SweepTask> tasks_;
  const SweepOptions& options_;
  const SweepProgress& progress_;
  std::string folder_, program_, batch_file_;
  std::vector<SweepResult> results_;
  std::size_t parts_ = 0;
  std::string first_line_, reason_;  // of the launcher: its first line, and the first with words
};

std::optional<std::size_t> number_in_environment(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  const std::string_view digits = text;
  std::size_t value = 0;
  const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc() && rest == digits.data() + digits.size() ? std::optional(value) : std::nullopt;
}

// part and number of parts
std::pair<std::size_t, std::size_t> own_part() {
  constexpr const char* kNames[][2] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                       {"PMI_RANK", "PMI_SIZE"},
                                       {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT"}};
  for (const auto& [rank, size] : kNames) {
    const std::optional<std::size_t> part = number_in_environment(rank), parts = number_in_environment(size);
    if (part && parts && *part < *parts) return {*part, *parts};
  }
  throw Failure(ExitCode::bad_input,
                "this process is no part of an engine: neither MPI's rank nor Slurm's array index is in its "
                "environment; nothing was run; use 'slewring sweep --engine'");
}

}  // namespace

std::vector<SweepResult> run_batch(std::span<const SweepTask> tasks, const SweepOptions& options,
                                   const SweepProgress& progress) {
  return Batch(tasks, options, progress).run();
}

void run_batch_part(const std::string& batch_file) {
  const auto [part, parts] = own_part();
  const std::optional<Json> batch = read_result(batch_file);
  if (!batch) throw Failure(ExitCode::bad_input, batch_file + " is no batch of a sweep; nothing was run");
  SweepOptions options;
  options.folder = std::filesystem::path(batch_file).parent_path().string();
  options.workers = 1;
  options.program = batch->at("program").text();
  std::vector<SweepTask> tasks;
  const std::vector<Json>& all = batch->at("tasks").items();
  for (std::size_t i = part; i < all.size(); i += parts) {
    tasks.push_back({.key = all[i].at("key").text(),
                     .label = all[i].at("label").text(),
                     .arguments = all[i].at("arguments").texts()});
  }
  const std::vector<SweepResult> results = run_sweep(tasks, options, [](const SweepState&) { return true; });
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i].failure.empty())
      write_text(failure_file(options.folder, tasks[i].key).string(), results[i].failure);
  }
}

}  // namespace slew::analysis
