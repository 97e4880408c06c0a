// SPDX-License-Identifier: Apache-2.0
#include "keys/openssl.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>

#include "core/child_process.h"
#include "core/failure.h"

namespace slew::keys {
namespace {

constexpr const char* kOpenssl = "/usr/bin/openssl";
constexpr int kLookAgain = 20;  // ms

}  // namespace

bool try_openssl(const std::vector<std::string>& arguments, std::string& output) {
  if (::access(kOpenssl, X_OK) != 0) {
    throw Failure(ExitCode::resources,
                  fmt::format("{} is not there; install the package openssl; nothing was changed", kOpenssl));
  }
  ChildProcess openssl("openssl", kOpenssl, arguments);
  output.clear();
  const auto listen = [&] {
    for (const std::string& line : openssl.take_lines()) output += line + '\n';
  };
  while (!openssl.poll_end()) {
    pollfd pipe{openssl.output_fd(), POLLIN, 0};
    ::poll(&pipe, 1, kLookAgain);
    listen();
  }
  listen();
  return openssl.poll_end()->signal == 0 && openssl.poll_end()->exit_code == 0;
}

std::string run_openssl(const std::vector<std::string>& arguments) {
  std::string output;
  if (try_openssl(arguments, output)) return output;
  throw Failure(ExitCode::failed, fmt::format("openssl {} failed: {}", arguments.front(), output));
}

}  // namespace slew::keys
