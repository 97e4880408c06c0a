// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/preemption.h"

#include <zlib.h>

#include <array>
#include <fstream>
#include <string_view>

namespace slew::analysis {
namespace {

constexpr int kLongestLine = 4096;

// "none voluntary (full)": the one in parentheses
std::string chosen_in(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (std::string word; in >> word;) {
    if (word.size() > 2 && word.front() == '(' && word.back() == ')') return word.substr(1, word.size() - 2);
  }
  return "";
}

// the last one counts, as for the kernel
std::string requested_in(const std::filesystem::path& command_line) {
  constexpr std::string_view kKey = "preempt=";
  std::string model;
  std::ifstream in(command_line);
  for (std::string word; in >> word;) {
    if (word.starts_with(kKey)) model = word.substr(kKey.size());
  }
  return model;
}

// A kernel's configuration, packed or not.
std::string built_with(const std::filesystem::path& config) {
  constexpr std::array<std::array<std::string_view, 2>, 5> kModels = {{{"CONFIG_PREEMPT_RT=y", "rt"},
                                                                       {"CONFIG_PREEMPT=y", "full"},
                                                                       {"CONFIG_PREEMPT_LAZY=y", "lazy"},
                                                                       {"CONFIG_PREEMPT_VOLUNTARY=y", "voluntary"},
                                                                       {"CONFIG_PREEMPT_NONE=y", "none"}}};
  const gzFile in = gzopen(config.c_str(), "rb");
  if (in == nullptr) return "";
  std::size_t found = kModels.size();
  std::array<char, kLongestLine> text{};
  while (gzgets(in, text.data(), kLongestLine) != nullptr) {
    std::string_view line(text.data());
    line = line.substr(0, line.find('\n'));
    for (std::size_t i = 0; i < found; ++i) {
      if (line == kModels[i][0]) found = i;
    }
  }
  gzclose(in);
  return found < kModels.size() ? std::string(kModels[found][1]) : "";
}

}  // namespace

std::string preemption_model(const std::string& release, const std::string& version,
                             const std::filesystem::path& root) {
  if (version.find("PREEMPT_RT") != std::string::npos) return "rt";
  for (const std::string& model :
       {chosen_in(root / "sys/kernel/debug/sched/preempt"), requested_in(root / "proc/cmdline"),
        built_with(root / "proc/config.gz"), built_with(root / ("boot/config-" + release))}) {
    if (!model.empty()) return model;
  }
  return "unknown";
}

}  // namespace slew::analysis
