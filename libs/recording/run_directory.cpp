// SPDX-License-Identifier: Apache-2.0
#include "recording/run_directory.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>

namespace slew::recording {
namespace {

constexpr int kMostRunsOfOneName = 10'000;      // a thousand sessions a second would still find a name
constexpr std::size_t kMostSceneLetters = 100;  // file systems take 255 bytes

}  // namespace

std::string file_name(std::string_view scene) {
  std::string name;
  for (const char c : scene.substr(0, kMostSceneLetters)) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
    name += is_plain ? c : '_';
  }
  // no hidden directory, none that a command takes for an option
  if (name.empty() || name.front() == '.' || name.front() == '-') name.insert(0, "scene");
  return name;
}

std::string run_name(std::string_view scene, std::int64_t wall_clock_ns) {
  const std::time_t seconds = wall_clock_ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return fmt::format("{}-{:04}{:02}{:02}-{:02}{:02}{:02}", file_name(scene), local.tm_year + 1900, local.tm_mon + 1,
                     local.tm_mday, local.tm_hour, local.tm_min, local.tm_sec);
}

Status create_run_directory(const std::filesystem::path& root, std::string_view scene, std::int64_t wall_clock_ns,
                            std::filesystem::path& created) {
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error) {
    return Status::error(ExitCode::storage,
                         fmt::format("{}: cannot create the directory for recordings ({}); nothing is recorded; choose "
                                     "another one with --out DIR",
                                     root.string(), error.message()));
  }
  const std::string name = run_name(scene, wall_clock_ns);
  for (int number = 1; number <= kMostRunsOfOneName; ++number) {
    created = root / (number == 1 ? name : fmt::format("{}-{}", name, number));
    // mkdir is the arbiter between programs
    if (::mkdir(created.c_str(), 0755) == 0) return Status::ok();
    if (errno != EEXIST) break;
  }
  return Status::error(ExitCode::storage,
                       fmt::format("{}: cannot create the directory of this run ({}); nothing is recorded; choose "
                                   "another place with --out DIR",
                                   created.string(), std::strerror(errno)));
}

}  // namespace slew::recording
