// SPDX-License-Identifier: Apache-2.0
// Tests that hold for every middleware of this build.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <memory>
#include <ostream>
#include <string>

#include "tests/support/test_domain.h"
#include "transport/network.h"

namespace slew::testing {

[[nodiscard]] inline transport::Network network_of(const TestDomain& domain, transport::Middleware middleware) {
  return {domain.number(), "lo", {}, {}, middleware};
}

// Ends the test where the middleware is not there.
inline void need(transport::Middleware middleware) {
  if (!transport::is_built(middleware)) GTEST_SKIP() << "this build has no Fast DDS: libfastrtps-dev was not there";
}

// Names of tests hold letters and digits.
[[nodiscard]] inline std::string text_of(transport::Middleware middleware) {
  std::string name = transport::kMiddlewares[static_cast<std::size_t>(middleware)];
  std::erase_if(name, [](unsigned char c) { return std::isalnum(c) == 0; });
  return name;
}
[[nodiscard]] inline std::string name_of(const ::testing::TestParamInfo<transport::Middleware>& info) {
  return text_of(info.param);
}

class OverMiddleware : public ::testing::TestWithParam<transport::Middleware> {
 protected:
  void SetUp() override { need(GetParam()); }
  [[nodiscard]] transport::Network network() const { return network_of(domain_, GetParam()); }

  std::unique_ptr<transport::Transport> connect(const transport::Endpoint& endpoint) const {
    std::unique_ptr<transport::Transport> opened;
    const Status status = transport::open_transport(network(), endpoint, opened);
    EXPECT_TRUE(status.is_ok()) << status.text;
    return opened;
  }

  TestDomain domain_;
};

inline const auto kAllMiddlewares = ::testing::Values(transport::Middleware::cyclone, transport::Middleware::fastdds,
                                                      transport::Middleware::fastdds_shared);

}  // namespace slew::testing

namespace slew::transport {

inline void PrintTo(Middleware middleware, std::ostream* out) {
  *out << kMiddlewares[static_cast<std::size_t>(middleware)];
}

}  // namespace slew::transport
