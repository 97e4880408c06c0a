// SPDX-License-Identifier: Apache-2.0
#include "program/node_program.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <vector>

#include "core/arithmetic_self_test.h"
#include "core/failure.h"
#include "core/file_size_limit.h"
#include "core/printable.h"
#include "core/real_time_thread.h"
#include "core/text_output.h"
#include "node/driver.h"
#include "node/identity.h"
#include "node/metered_transport.h"
#include "options/completion.h"
#include "options/manual.h"
#include "scene/diagnostic.h"

namespace slew::program {
namespace {

int report(const std::string& program, const char* text, ExitCode code) noexcept {
  std::fflush(stdout);
  try {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), printable_lines(text).c_str());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: out of memory\n", program.c_str());
  }
  return static_cast<int>(code);
}

bool check_processor(const std::string& program) noexcept {
  const char* missing = nullptr;
  if (processor_fits(missing)) return true;
  std::fprintf(stderr,
               "%s: this processor lacks %s, which this build uses; nothing was started; build with "
               "-DSLEWRING_MARCH=x86-64-v2 on all machines of a session\n",
               program.c_str(), missing);
  return false;
}

// the process or the machine has no more files, memory or threads
bool is_of_resources(const std::error_code& code) {
  return code == std::errc::too_many_files_open || code == std::errc::too_many_files_open_in_system ||
         code == std::errc::not_enough_memory || code == std::errc::resource_unavailable_try_again;
}

int guarded(const std::string& program, const std::function<ExitCode()>& body) noexcept {
  let_writes_fail_at_the_size_limit();
  try {
    return static_cast<int>(body());
  } catch (const Failure& failure) {
    return report(program, failure.what(), failure.code());
  } catch (const scene::LoadError& error) {
    // one line per problem, each beginning with its place in the file
    std::fflush(stdout);
    std::fprintf(stderr, "%s\n", printable_lines(error.what()).c_str());
    return static_cast<int>(ExitCode::bad_input);
  } catch (const std::bad_alloc&) {
    return report(program, "out of memory; the program ends; close other programs or use a smaller scene",
                  ExitCode::resources);
  } catch (const std::system_error& error) {
    // a write to standard output failed: finish_output() reports it
    if (std::ferror(stdout) != 0) return static_cast<int>(ExitCode::ok);
    if (!is_of_resources(error.code())) return report(program, error.what(), ExitCode::failed);
    std::fflush(stdout);
    std::fprintf(stderr,
                 "%s: the system gives this process no more (%s); the program ends; raise the limit (ulimit -n for "
                 "files, -d and -v for memory, -u for threads) or end other programs\n",
                 program.c_str(), error.what());
    return static_cast<int>(ExitCode::resources);
  } catch (const std::exception& error) {
    return report(program, error.what(), ExitCode::failed);
  }
}

// The reader of standard output has closed its end, as `| head` does.
bool is_output_closed_by_its_reader() noexcept {
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

// Flushes standard output, std::cout included, and tests every write to it since the start. Storage instead of ok where
// one was lost; another code stays.
int finish_output(const std::string& program, int code) noexcept {
  const bool was_lost_before = std::ferror(stdout) != 0;
  errno = 0;
  const bool is_lost = std::fflush(stdout) != 0 || was_lost_before;
  const int error = errno;
  if (!is_lost || is_output_closed_by_its_reader()) return code;
  std::fprintf(stderr,
               "%s: standard output cannot be written (%s); what was printed is incomplete; free space or send the "
               "output to another place\n",
               program.c_str(), error != 0 ? std::strerror(error) : "a write failed; is the disk full?");
  return code == static_cast<int>(ExitCode::ok) ? static_cast<int>(ExitCode::storage) : code;
}

// --complete and --write-manual.
std::optional<std::function<ExitCode()>> service_of(const options::Program& program, int argc,
                                                    const char* const* argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.empty()) return std::nullopt;
  if (words[0] == "--complete") {
    return [&program, rest = std::vector(words.begin() + 1, words.end())] {
      fmt::print("{}", to_lines(options::complete(program.text(), rest)));
      return ExitCode::ok;
    };
  }
  if (words[0] == "--write-manual" && words.size() == 2) {
    return [&program, folder = words[1]] {
      for (const options::ManualPage& page : options::manual_pages(program.text(), node::version())) {
        write_text(folder + "/" + page.name + ".1", page.text);
      }
      return ExitCode::ok;
    };
  }
  return std::nullopt;
}

}  // namespace

int run_program(options::Program& program, int argc, const char* const* argv) noexcept {
  const std::string& name = program.name();
  if (!check_processor(name)) return static_cast<int>(ExitCode::resources);
  program.version(name + " " + node::build_id(), node::version_json(name));
  if (const auto service = service_of(program, argc, argv)) return finish_output(name, guarded(name, *service));
  int exit_code = 0;
  if (program.parse(argc, argv, exit_code)) exit_code = guarded(name, [&program] { return program.run(); });
  return finish_output(name, exit_code);
}

void apply_real_time(const NodeOptions& options, const std::string& program) {
  if (options.cpu >= 0) require(run_on_cpu(options.cpu));
  if (!options.is_real_time) return;
  const Status status = make_real_time(options.priority);
  if (!status.is_ok()) std::fprintf(stderr, "%s: warning: %s\n", program.c_str(), printable_lines(status.text).c_str());
}

std::optional<ExitCode> run_node(node::Node& node) {
  node::install_signal_handlers();
  const ExitCode code = node::run_alone(node, node::heap_meter());
  if (node.member().is_withdrawn()) return std::nullopt;
  const std::string& reason = node.member().reason();
  // the end by a signal needs no message
  const bool was_asked_to_end = static_cast<int>(code) == node::stop_requested.load();
  if (code != ExitCode::ok && !was_asked_to_end && !reason.empty()) throw Failure(code, reason);
  return code;
}

ExitCode run_until_in_session(const std::function<std::optional<ExitCode>()>& run) {
  while (true) {
    if (const std::optional<ExitCode> code = run()) return *code;
  }
}

}  // namespace slew::program
