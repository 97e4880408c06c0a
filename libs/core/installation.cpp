// SPDX-License-Identifier: Apache-2.0
#include "core/installation.h"

#include <filesystem>
#include <system_error>

namespace slew {
namespace {

std::filesystem::path own_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

}  // namespace

std::string sibling_program(const std::string& name) {
  const std::filesystem::path own = own_folder();
  std::error_code error;
  for (const char* folder : {".", "../lib/slewring", "../../bin"}) {
    const std::filesystem::path path = (own / folder / name).lexically_normal();
    if (std::filesystem::is_regular_file(path, error)) return path.string();
  }
  return (own / name).string();
}

std::string installed_scenes() {
  const std::filesystem::path own = own_folder();
  std::error_code error;
  for (const char* prefix : {"..", "../.."}) {
    const std::filesystem::path path = (own / prefix / "share/slewring/scenes").lexically_normal();
    if (std::filesystem::is_directory(path, error)) return path.string();
  }
  return "";
}

}  // namespace slew
