// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep/sweep.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include "analysis/sweep/batch.h"
#include "core/child_process.h"
#include "core/failure.h"
#include "core/installation.h"
#include "core/json.h"
#include "core/state_hash.h"

namespace slew::analysis {
namespace {

constexpr int kPollMs = 20;  // between two looks at the processes

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return;
  throw Failure(ExitCode::storage, fmt::format("cannot make the folder {} ({}); nothing was run; name another one",
                                               folder, error.message()));
}

class Sweep {
 public:
  Sweep(std::span<const SweepTask> tasks, const SweepOptions& options, const SweepProgress& progress)
      : tasks_(tasks), options_(options), progress_(progress), results_(tasks.size()) {}

  std::vector<SweepResult> run() {
    for (std::size_t i = 0; i < tasks_.size(); ++i) take_kept(i);
    while (!is_over()) {
      while (running_.size() < static_cast<std::size_t>(options_.workers) && next_ < tasks_.size()) start_next();
      if (!progress_(state())) break;
      if (!running_.empty()) wait();
      collect();
    }
    running_.clear();  // kills the running processes
    static_cast<void>(progress_(state()));
    return std::move(results_);
  }

 private:
  struct Running {
    std::size_t task;
    std::unique_ptr<ChildProcess> process;
    std::string last_line;
  };

  [[nodiscard]] std::string file_of(std::size_t task) const { return result_file(options_.folder, tasks_[task].key); }

  void take_kept(std::size_t task) {
    if (options_.is_fresh) return;
    std::optional<Json> value = read_result(file_of(task));
    if (!value) return;
    results_[task] = {.is_done = true, .was_kept = true, .value = std::move(*value), .failure = {}};
  }

  void start_next() {
    const std::size_t task = next_++;
    if (results_[task].is_done) return;
    std::filesystem::remove(file_of(task));
    std::vector<std::string> arguments = tasks_[task].arguments;
    arguments.insert(arguments.end(), {"--result", file_of(task)});
    const std::string program = options_.program.empty() ? sibling_program("slewring") : options_.program;
    running_.push_back({task, std::make_unique<ChildProcess>(tasks_[task].label, program, arguments), ""});
  }

  void wait() {
    std::vector<pollfd> pipes;
    for (const Running& one : running_) pipes.push_back({one.process->output_fd(), POLLIN, 0});
    static_cast<void>(poll(pipes.data(), pipes.size(), kPollMs));
    // a closed pipe is always ready: its process is about to end
    if (std::any_of(pipes.begin(), pipes.end(), [](const pollfd& p) { return (p.revents & POLLHUP) != 0; })) {
      usleep(1000);
    }
  }

  void collect() {
    std::erase_if(running_, [this](Running& one) {
      const std::optional<ProcessEnd>& end = one.process->poll_end();
      for (std::string& line : one.process->take_lines()) one.last_line = std::move(line);
      if (!end) return false;
      SweepResult& result = results_[one.task];
      result.is_done = true;
      std::optional<Json> value = read_result(file_of(one.task));
      if (value) {
        result.value = std::move(*value);
      } else {
        result.failure = "its process " + end->text() + (one.last_line.empty() ? "" : ": " + one.last_line);
      }
      return true;
    });
  }

  [[nodiscard]] bool is_over() const { return next_ >= tasks_.size() && running_.empty(); }

  [[nodiscard]] SweepState state() const {
    SweepState state;
    double all = 0, done = 0;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (results_[i].is_done) ++state.done;
      // kept results took no time
      if (results_[i].was_kept) continue;
      all += tasks_[i].weight;
      if (results_[i].is_done) done += tasks_[i].weight;
    }
    state.all = tasks_.size();
    state.share = all > 0 ? done / all : 1;
    for (const Running& one : running_) state.doing += (state.doing.empty() ? "" : " | ") + tasks_[one.task].label;
    return state;
  }

  std::span<const SweepTask> tasks_;
  const SweepOptions& options_;
  const SweepProgress& progress_;
  std::vector<SweepResult> results_;
  std::vector<Running> running_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<SweepResult> run_sweep(std::span<const SweepTask> tasks, const SweepOptions& options,
                                   const SweepProgress& progress) {
  make_folder(options.folder);
  if (options.engine != Engine::local) return run_batch(tasks, options, progress);
  return Sweep(tasks, options, progress).run();
}

std::optional<Json> read_result(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  return Json::parse(std::string(std::istreambuf_iterator<char>(in), {}));
}

std::string result_file(const std::string& folder, const std::string& key) {
  return (std::filesystem::path(folder) / (key + ".json")).string();
}

void write_result(const std::string& file, const Json& value) {
  const std::string unfinished = file + "." + std::to_string(getpid());
  std::ofstream out(unfinished, std::ios::binary);
  out << value.dump();
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(unfinished, file, error);
  if (!out || error) {
    throw Failure(ExitCode::storage, "cannot write " + file + "; the result is lost; free some space and run it again");
  }
}

std::string result_text(const scene::Scene& scene) {
  std::string text = scene.expanded_text;
  for (const scene::Asset& asset : scene.assets) {
    for (const std::uint8_t byte : asset.sha256) text += fmt::format("{:02x}", byte);
  }
  return text;
}

std::string key_of(std::span<const std::string> texts) {
  StateHash hash;
  for (const std::string& text : texts) {
    hash.add(text.size());
    hash.add_bytes(text.data(), text.size());
  }
  return fmt::format("{:016x}", hash.digest());
}

}  // namespace slew::analysis
