// SPDX-License-Identifier: Apache-2.0
// The directory of a run: runs/<scene>-<time>/, a new one for every session.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/status.h"

namespace slew::recording {

inline constexpr const char* kRecordingFileName = "session.mcap";

// A scene's name as the start of a file name: characters other than letters, digits, '.', '_' and '-' become '_'.
[[nodiscard]] std::string file_name(std::string_view scene);

// "<file_name(scene)>-<YYYYMMDD>-<HHMMSS>" in local time.
[[nodiscard]] std::string run_name(std::string_view scene, std::int64_t wall_clock_ns);

// Creates root/<run_name>, or root/<run_name>-2, -3 ... when it exists; two programs at the same instant get two
// directories. Creates root when it is missing. Errors: storage.
[[nodiscard]] Status create_run_directory(const std::filesystem::path& root, std::string_view scene,
                                          std::int64_t wall_clock_ns, std::filesystem::path& created);

}  // namespace slew::recording
