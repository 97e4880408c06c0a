// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

constexpr double kLastDomain = 230;  // DDS: a port is 7400 + 250 domain + ...

int refuse(const char* program, const char* key, const char* problem, const char* usage) {
  std::fprintf(stderr, "%s: %s: %s; nothing was moved\n%s", program, key, problem, usage);
  return 2;
}

// the whole text as a finite number
bool read_number(const char* text, double& number) {
  char* end = nullptr;
  number = std::strtod(text, &end);
  return end != text && *end == '\0' && std::isfinite(number);
}

}  // namespace

int parse(const char* program, int argc, char** argv, const std::vector<Option>& options, const char* usage) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--help") != 0 && std::strcmp(argv[i], "-h") != 0) continue;
    std::fputs(usage, stdout);
    return 1;
  }
  for (int i = 1; i < argc; i += 2) {
    const char* key = argv[i];
    const auto option =
        std::find_if(options.begin(), options.end(), [key](const Option& o) { return std::strcmp(o.key, key) == 0; });
    if (option == options.end()) return refuse(program, key, "unknown option", usage);
    if (i + 1 == argc) return refuse(program, key, "expected a value", usage);
    if (option->text != nullptr) {
      *option->text = argv[i + 1];
    } else if (!read_number(argv[i + 1], *option->number)) {
      return refuse(program, key, "expected a number", usage);
    }
  }
  return 0;
}

void SessionOptions::add_to(std::vector<Option>& options) {
  options.push_back({"--session", nullptr, &session});
  options.push_back({"--name", nullptr, &name});
  options.push_back({"--interface", nullptr, &interface_name});
  options.push_back({"--peers", nullptr, &peers});
  options.push_back({"--domain", &domain, nullptr});
  options.push_back({"--seconds", &seconds, nullptr});
}

int SessionOptions::check(const char* program, const char* usage) const {
  if (session.empty()) return refuse(program, "--session", "expected the name of a running session", usage);
  if (domain < 0 || domain > kLastDomain || domain != std::floor(domain)) {
    return refuse(program, "--domain", "expected a whole number, 0 to 230", usage);
  }
  return 0;
}
