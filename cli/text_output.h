#pragma once

#include <string>

namespace slew::cli {

// Writes a file; "-" is standard output. Throws Failure (storage).
void write_text(const std::string& path, const std::string& text);

}  // namespace slew::cli
