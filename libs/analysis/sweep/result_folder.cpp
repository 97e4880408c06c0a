// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep/result_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "analysis/sweep/sweep.h"
#include "core/failure.h"
#include "core/text_output.h"

namespace slew::analysis {
namespace {

namespace fs = std::filesystem;

struct TaskFiles {
  const char* task;
  const char* manifest;
  const char* result;
};
constexpr TaskFiles kTasks[] = {{"sweep", "sweep.json", "rows.json"}, {"fit", "search.json", "fit.json"}};

int locked(const fs::path& folder) {
  const std::string file = (folder / "lock").string();
  const int lock = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
  if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0) return lock;
  const int error = errno;
  if (lock >= 0) close(lock);
  if (lock >= 0 && error == EWOULDBLOCK) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("the folder {} is in use by another sweep or fit that still runs; nothing was run; wait "
                              "for its end, or name another folder with -o",
                              folder.string()));
  }
  throw Failure(ExitCode::storage, fmt::format("cannot lock {} ({}); nothing was run; name another folder with -o",
                                               file, std::strerror(error)));
}

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& what, const std::string& remedy) {
  throw Failure(ExitCode::bad_input,
                fmt::format("the folder {} holds {}; nothing was run; name another folder with -o{}", folder.string(),
                            what, remedy));
}

void refuse_other_task(const fs::path& folder, const FolderUse& use) {
  for (const TaskFiles& files : kTasks) {
    const bool is_own = use.task == files.task;
    const bool has_manifest = fs::exists(folder / files.manifest);
    if (!has_manifest && !fs::exists(folder / files.result)) continue;
    if (!is_own) refuse_folder(folder, fmt::format("the results of a {}", files.task), "");
    if (use.is_fresh) continue;
    const std::string remedy = ", or discard those rows with --anew";
    const std::optional<Json> there = read_result((folder / files.manifest).string());
    if (!there) refuse_folder(folder, fmt::format("rows of another {}: they have no manifest", use.task), remedy);
    for (const auto& [member, what] : use.members) {
      const Json* before = there->find(member);
      if (before != nullptr && before->dump() == use.manifest.at(member).dump()) continue;
      refuse_folder(folder, fmt::format("rows of another {}: {}", use.task, what), remedy);
    }
  }
}

}  // namespace

ResultFolder::ResultFolder(const std::string& folder, const FolderUse& use) {
  const fs::path at = folder;
  std::error_code error;
  fs::create_directories(at, error);
  if (error) {
    throw Failure(ExitCode::storage, fmt::format("cannot make the folder {} ({}); nothing was run; name another one",
                                                 folder, error.message()));
  }
  lock_ = locked(at);
  try {
    refuse_other_task(at, use);
    if (use.is_fresh) fs::remove_all(at / "rows", error);
    fs::create_directories(at / "rows", error);  // write_text() reports its absence
    for (const TaskFiles& files : kTasks) {
      if (use.task == files.task) write_text((at / files.manifest).string(), use.manifest.dump(2) + '\n');
    }
  } catch (...) {
    close(lock_);
    throw;
  }
}

ResultFolder::~ResultFolder() {
  close(lock_);
}

}  // namespace slew::analysis
