// SPDX-License-Identifier: Apache-2.0
#include "view_node/saved_files.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "core/failure.h"
#include "core/installation.h"
#include "core/json.h"

namespace slew::view_node {

void SavedFiles::start(const char* command, const std::string& name, Done done) {
  const bool is_saving = std::string_view(command) == "save";
  if (running_.size() >= kMostAtOnce)
    return done("four states are being saved or loaded; nothing was done; try again later", kJoinStep);
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return done(folder_ + ": " + error.message() + "; nothing was done; choose a --saves folder", kJoinStep);
  const std::string file = (std::filesystem::path(folder_) / (name + ".saved")).string();
  // the remedies of the command line are options that a client has not
  const bool is_there = std::filesystem::exists(file, error);
  if (is_saving == is_there) {
    return done(is_there ? file + ": the file exists already; it was left as it is; choose another name"
                         : file + ": there is no such file; nothing was done; choose the name of a saved state",
                kJoinStep);
  }
  std::vector<std::string> arguments = {"control", command, file, "--session", session_.session, "--json"};
  const std::vector<std::string> network = node::network_arguments(session_);
  arguments.insert(arguments.end(), network.begin(), network.end());
  try {
    running_.push_back(
        {std::make_unique<ChildProcess>(command, sibling_program("slewring"), arguments), std::move(done)});
  } catch (const Failure& failure) {  // there is no process for it
    done(failure.what(), kJoinStep);
  }
}

void SavedFiles::poll() {
  for (std::size_t i = 0; i < running_.size();) {
    const std::optional<ProcessEnd> end = running_[i].process->poll_end();
    for (const std::string& line : running_[i].process->take_lines()) running_[i].output += line + "\n";
    if (!end) {
      ++i;
      continue;
    }
    const Running ended = std::move(running_[i]);
    running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
    const bool is_done = end->exit_code == 0 && end->signal == 0;
    const std::size_t begin = ended.output.find('{');
    const auto answer =
        begin == std::string::npos ? std::nullopt : Json::parse(std::string_view(ended.output).substr(begin));
    const Json* const step = answer ? answer->find("step") : nullptr;
    if (is_done && step != nullptr && step->is_number()) {
      ended.done("", step->integer());
    } else {
      ended.done(ended.output.empty() ? end->text() : ended.output.substr(0, ended.output.find_last_not_of('\n') + 1),
                 kJoinStep);
    }
  }
}

}  // namespace slew::view_node
