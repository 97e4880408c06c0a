// SPDX-License-Identifier: Apache-2.0
// A folder of this process for temporary files during a measurement: recordings, files of a load.
#pragma once

#include <string>

namespace slew::analysis {

// Exists as long as the object and is removed with all its files.
class PassingFolder {
 public:
  // Makes a folder in `parent`. The parent is made when it is missing, and then removed again when it is empty. Throws
  // Failure (storage).
  explicit PassingFolder(const std::string& parent);
  ~PassingFolder();
  PassingFolder(const PassingFolder&) = delete;
  PassingFolder& operator=(const PassingFolder&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string parent_, path_;
  bool is_parent_new_ = false;
};

}  // namespace slew::analysis
