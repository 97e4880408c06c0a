// The openssl command line: makes keys, signs certificates and documents.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slew::keys {

// Standard output and error. Throws Failure: resources when there is no openssl, failed with its last words otherwise.
std::string run_openssl(const std::vector<std::string>& arguments);

// Whether it ended with code 0; its words are in `said`.
[[nodiscard]] bool try_openssl(const std::vector<std::string>& arguments, std::string& said);

}  // namespace slew::keys
