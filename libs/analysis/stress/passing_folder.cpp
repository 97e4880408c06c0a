// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/passing_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "core/failure.h"

namespace slew::analysis {

PassingFolder::PassingFolder(const std::string& parent)
    : parent_(parent), path_(fmt::format("{}/stress-{}", parent, getpid())) {
  std::error_code error;
  is_parent_new_ = std::filesystem::create_directories(parent_, error);
  if (!error) std::filesystem::create_directory(path_, error);
  if (!error) return;
  const std::string reason = error.message();
  if (is_parent_new_) std::filesystem::remove(parent_, error);
  throw Failure(ExitCode::storage,
                fmt::format("{}: cannot be created ({}); nothing was run; choose another folder with "
                            "--folder DIR",
                            path_, reason));
}

PassingFolder::~PassingFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (is_parent_new_) std::filesystem::remove(parent_, ignored);
}

}  // namespace slew::analysis
