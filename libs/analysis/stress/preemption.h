// SPDX-License-Identifier: Apache-2.0
// The preemption model of the kernel: it decides how long a thread with real-time scheduling waits for system calls of
// others.
#pragma once

#include <filesystem>
#include <string>

namespace slew::analysis {

// The preemption model of this machine's kernel: "none", "voluntary", "full", "lazy", "rt" or, without any source,
// "unknown". release: the kernel's, "6.1.0-18-amd64"; version: "#1 SMP PREEMPT_DYNAMIC ...", as uname() has them.
//
// In this order: PREEMPT_RT in the version; /sys/kernel/debug/sched/preempt, which root alone may read; `preempt=` of
// /proc/cmdline; the kernel's build configuration, from /proc/config.gz or /boot/config-<release>.
// root: where these folders are, "/" but for a test.
[[nodiscard]] std::string preemption_model(const std::string& release, const std::string& version,
                                           const std::filesystem::path& root = "/");

}  // namespace slew::analysis
