#include "cli/text_output.h"

#include <fstream>
#include <iostream>

#include "cli_support/failure.h"

namespace slew::cli {

void write_text(const std::string& path, const std::string& text) {
  if (path == "-") {
    std::cout << text << std::flush;
    return;
  }
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) {
    throw cli_support::Failure(ExitCode::storage,
                               "cannot write " + path + "; nothing was kept; name another file with -o");
  }
}

}  // namespace slew::cli
