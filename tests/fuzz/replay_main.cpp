// SPDX-License-Identifier: Apache-2.0
// A fuzzer without libFuzzer: gives it kept inputs, and changed ones of them from a fixed seed.
//   REPLAY_PROGRAM CHANGED FOLDER_OR_FILE...
#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
// defined by the fuzzers that need it
extern "C" [[gnu::weak]] std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                                             unsigned int seed);

namespace {

using Input = std::vector<std::uint8_t>;

std::mt19937_64 random_bits{20'260'501};

std::size_t below(std::size_t count) {
  return random_bits() % count;
}

}  // namespace

// A few bytes other, gone or in between; as libFuzzer's, at most max_size long.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size) {
  Input input(data, data + size);
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const auto at = input.begin() + static_cast<std::ptrdiff_t>(below(input.size() + 1));
    const std::size_t how = input.end() == at ? 2 : below(4);
    if (how == 0) {
      *at = static_cast<std::uint8_t>(random_bits());
    } else if (how == 1) {
      *at = static_cast<std::uint8_t>(*at ^ 1u << below(8));
    } else if (how == 2) {
      input.insert(at, 1 + below(4), static_cast<std::uint8_t>(random_bits()));
    } else {
      const auto rest = static_cast<std::size_t>(input.end() - at);
      input.erase(at, at + static_cast<std::ptrdiff_t>(1 + below(std::min<std::size_t>(rest, 8))));
    }
  }
  input.resize(std::min(input.size(), max_size));
  std::copy(input.begin(), input.end(), data);
  return input.size();
}

namespace {

constexpr std::size_t kLongest = 65'536;

// text of a failed claim, for the signal handler
char now[512];

extern "C" void report_fatal_signal(int signal) {
  static_cast<void>(std::fprintf(stderr, "the claim failed, or the program, with signal %d on %s\n", signal, now));
  std::_Exit(1);
}

// A sanitizer reports more, where it has a handler.
void report_signal(int signal) {
  struct sigaction present {};
  const bool is_known = sigaction(signal, nullptr, &present) == 0;
  if (is_known && (present.sa_flags & SA_SIGINFO) == 0 && present.sa_handler == SIG_DFL)
    std::signal(signal, report_fatal_signal);
}

void give(const Input& input, const std::string& name) {
  std::snprintf(now, sizeof now, "%s", name.c_str());
  // a copy with its own end: a sanitizer sees reads beyond it
  const Input copy(input.begin(), input.end());
  LLVMFuzzerTestOneInput(copy.data(), copy.size());
}

Input changed(const Input& input) {
  Input result = input;
  const std::size_t most = std::min(kLongest, input.size() + 64);
  result.resize(std::max(most, input.size()));
  const std::size_t size = LLVMFuzzerCustomMutator != nullptr
                               ? LLVMFuzzerCustomMutator(result.data(), input.size(), result.size(),
                                                         static_cast<unsigned int>(random_bits()))
                               : LLVMFuzzerMutate(result.data(), input.size(), result.size());
  result.resize(size);
  return result;
}

std::vector<std::filesystem::path> files_of(int argc, char** argv) {
  std::vector<std::filesystem::path> files;
  for (int i = 2; i < argc; ++i) {
    if (!std::filesystem::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::filesystem::path> files = files_of(argc, argv);
  if (files.empty()) {
    std::fprintf(stderr, "usage: %s CHANGED FOLDER_OR_FILE...; there are no inputs\n", argv[0]);
    return 2;
  }
  for (const int signal : {SIGILL, SIGTRAP, SIGABRT, SIGSEGV, SIGFPE}) report_signal(signal);
  std::vector<Input> inputs;
  for (const std::filesystem::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    give(inputs.back(), path.string());
  }
  const int changes = std::atoi(argv[1]);
  for (int i = 0; i < changes; ++i) {
    const std::size_t which = below(inputs.size());
    give(changed(inputs[which]), files[which].string() + ", changed input " + std::to_string(i));
  }
  std::printf("%zu kept inputs, %d changed ones\n", inputs.size(), changes);
  return 0;
}
