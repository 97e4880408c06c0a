// SPDX-License-Identifier: Apache-2.0
// The openssl command line: makes keys, signs certificates and documents.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slew::keys {

// Returns standard output and error. Throws Failure: resources when openssl is not installed, failed with its last
// output otherwise.
std::string run_openssl(const std::vector<std::string>& arguments);

// Whether it ended with code 0; its output is in `output`.
[[nodiscard]] bool try_openssl(const std::vector<std::string>& arguments, std::string& output);

}  // namespace slew::keys
