// SPDX-License-Identifier: Apache-2.0
// Problems of a scene: one Diagnostic for each with its place, all of them in one LoadError.
//
// Text of a diagnostic:  file:line:col: path: what is wrong; expected ...; did you mean 'x'?
// A problem of a whole file has no line and column, a problem from a line-based reader has no column, and a problem of
// an override reads "--set Bag.mass=5: ...".
#pragma once

#include <compare>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace slew::scene {

// Place in a source: line and column from 1, column in characters; line 0 means the source as a whole.
struct Mark {
  int source = 0;  // index into Report::sources
  int line = 0;
  int column = 0;
  auto operator<=>(const Mark&) const = default;
};

struct Diagnostic {
  std::string file;  // as the user named it, or "--set PATH=VALUE"
  int line = 0;      // 0: no line applies
  int column = 0;
  std::string path;        // "Bag.mass"; empty when the problem belongs to no key
  std::string what;        // the fault
  std::string expected;    // accepted value; may be empty
  std::string suggestion;  // a name that was probably meant; may be empty

  [[nodiscard]] std::string text() const;
};

// Thrown by load_file and load_text; what() is the text of all diagnostics, one a line.
class LoadError : public std::runtime_error {
 public:
  // omitted: number of further problems that are not in the list.
  LoadError(std::vector<Diagnostic> diagnostics, std::size_t omitted);
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const noexcept { return diagnostics_; }
  [[nodiscard]] std::size_t omitted() const noexcept { return omitted_; }
  // parts of the first problem: place, fault, accepted value
  [[nodiscard]] std::string first_reason() const;

 private:
  std::vector<Diagnostic> diagnostics_;
  std::size_t omitted_;
};

// A value's problem before its place is known.
struct ValueProblem {
  std::string what;
  std::string expected;
  std::string suggestion;

  // "what; expected ...; did you mean '...'?", on one line or more. `what` quotes the text that is wrong.
  [[nodiscard]] std::string text() const;
};

// Collects problems while a scene is read.
class Report {
 public:
  enum class Lines { numbered, none };  // none: an override, reported without line
  // Registers a file or override by its label; the index goes into marks.
  int add_source(std::string label, Lines lines = Lines::numbered);
  [[nodiscard]] bool is_override(const Mark& mark) const noexcept;
  // Layer of a place: included files, the scene's own file over them, overrides over both.
  [[nodiscard]] int layer(const Mark& mark) const noexcept;
  // Puts an included file's layer over those that were put before.
  void put_on_top(int source) noexcept { sources_[static_cast<std::size_t>(source)].layer = ++layers_; }
  // The diagnostic at this place, for warnings and problems.
  [[nodiscard]] Diagnostic at(const Mark& mark, std::string path, ValueProblem problem) const;

  void add(const Mark& mark, std::string path, ValueProblem problem);
  [[nodiscard]] bool is_clean() const noexcept { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }

  // Throws LoadError with the first `limit` problems, ordered by source, line and column.
  [[noreturn]] void fail(std::size_t limit) const;

 private:
  struct Entry {
    Mark mark;
    Diagnostic diagnostic;
  };
  struct Source {
    std::string label;
    Lines lines;
    int layer = 0;
  };
  std::vector<Source> sources_;
  int layers_ = 0;
  std::vector<Entry> entries_;
};

// Calls load(), which reads the file. Other failures (no unit database) become a LoadError too, except a lack of memory
// or file handles, which is no fault of the file.
template <typename Load>
auto guarded(const std::string& file, const Load& load) {
  try {
    return load();
  } catch (const LoadError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::system_error&) {
    throw;
  } catch (const std::exception& error) {
    throw LoadError({{.file = file, .path = "", .what = error.what(), .expected = "", .suggestion = ""}}, 0);
  }
}

}  // namespace slew::scene
