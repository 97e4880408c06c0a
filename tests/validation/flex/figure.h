// SPDX-License-Identifier: Apache-2.0
// A measured figure against its tolerance; with SLEWRING_FIGURES=1 as a row of a card's table.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace slew::flex::testing {

inline void expect_figure(const char* test_case, const std::string& quantity, double value, double tolerance) {
  EXPECT_LE(value, tolerance) << test_case << ": " << quantity;
  if (std::getenv("SLEWRING_FIGURES") != nullptr)
    std::printf("| %s | %s | %.1e | %.1e |\n", test_case, quantity.c_str(), tolerance, value);
}

}  // namespace slew::flex::testing
