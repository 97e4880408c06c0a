// SPDX-License-Identifier: Apache-2.0
// Command lines of the example controllers: "--key value" pairs, numbers checked, problems named.
#pragma once

#include <string>
#include <vector>

struct Option {
  const char* key;
  double* number;     // either a number
  std::string* text;  // or a text
};

// Fills the targets of the options. 0: go on; 1: the help was printed; 2: a problem was printed.
int parse(const char* program, int argc, char** argv, const std::vector<Option>& options, const char* usage);

// A controller's options for its session.
struct SessionOptions {
  std::string session;
  std::string name;
  std::string interface_name = "lo";
  std::string peers;
  double domain = 0;
  double seconds = 15;  // gives up after this wall time

  void add_to(std::vector<Option>& options);
  // 0, or 2 after printing the problem.
  int check(const char* program, const char* usage) const;
};
