// SPDX-License-Identifier: Apache-2.0
// The folder of a sweep or a fit: it belongs to one program at once, and holds the rows of one task alone.
//
// A file `lock` of the folder is locked (flock) for as long as the program works there; the system takes the lock back
// when the program ends in any way. A manifest beside it states what the rows depend on: another task in the folder is
// refused instead of replaced.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/json.h"

namespace slew::analysis {

struct FolderUse {
  std::string task;  // "sweep" or "fit": what the folder is for, and the manifest's name
  Json manifest;
  // Members of the manifest and what to report where one differs.
  std::vector<std::pair<std::string, std::string>> members;
  bool is_fresh = false;  // discards the rows of an earlier task of this kind
};

class ResultFolder {
 public:
  // Makes the folder with its subfolder `rows`, locks it and writes the manifest. Throws Failure: bad_input if another
  // program works there or the folder holds another task, storage if it cannot be made or locked.
  ResultFolder(const std::string& folder, const FolderUse& use);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

 private:
  int lock_ = -1;
};

}  // namespace slew::analysis
