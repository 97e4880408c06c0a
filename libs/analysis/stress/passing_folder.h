// A folder of this process for what comes and goes while deadlines are measured: recordings, files of a load.
#pragma once

#include <string>

namespace slew::analysis {

// There as long as the object, and gone with all that is in it.
class PassingFolder {
 public:
  // A folder in `parent`, which is made when it is not there, and goes again when nothing else is in it. Throws Failure
  // (storage).
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
