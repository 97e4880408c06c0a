// SPDX-License-Identifier: Apache-2.0
#include "scene/yaml_tree.h"

#include <fmt/format.h>
#include <yaml.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <unordered_map>
#include <utility>

#include "core/printable.h"
#include "scene/expression_signs.h"

namespace slew::scene {
namespace {

constexpr std::size_t kLongestQuote = 40;
// size of a map up to which keys are searched linearly
constexpr std::size_t kFewEntries = 16;

std::string shortened(const std::string& text) {
  if (text.size() <= kLongestQuote) return text;
  // not in the middle of a character
  std::size_t end = kLongestQuote;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

// Line breaks of YAML 1.1 that other programs do not treat as such.
constexpr std::string_view kOddBreaks[] = {"\xC2\x85", "\xE2\x80\xA8", "\xE2\x80\xA9"};

// What a text must not hold although its bytes are characters: what no YAML text holds unescaped, and odd breaks.
// Empty: nothing.
std::string unprintable(std::string_view text) {
  for (const std::string_view odd : kOddBreaks) {
    if (text.find(odd) != std::string_view::npos) return "line break U+0085, U+2028 or U+2029";
  }
  for (const std::string_view none : {std::string_view("\xEF\xBF\xBE"), std::string_view("\xEF\xBF\xBF")}) {
    if (text.find(none) != std::string_view::npos) return "U+FFFE or U+FFFF, which are no characters";
  }
  for (std::size_t at = text.find('\xC2'); at != std::string_view::npos; at = text.find('\xC2', at + 1)) {
    const auto next = static_cast<unsigned char>(at + 1 < text.size() ? text[at + 1] : 0);
    if (next >= 0x80 && next < 0xA0) return fmt::format("control character U+{:04X}", next);
  }
  return {};
}

bool is_null(std::string_view plain) {
  return plain.empty() || plain == "~" || plain == "null" || plain == "Null" || plain == "NULL";
}

// Builds the tree event by event. Each step returns false after a problem that makes the rest meaningless.
class TreeBuilder {
 public:
  enum class Expressions : std::uint8_t { none, hidden };  // hidden: without_signs()
  TreeBuilder(const SourceText& source, Expressions expressions, Report& report)
      : source_(source), report_(report), has_expressions_(expressions == Expressions::hidden) {}

  bool take(const yaml_event_t& event) {
    const yaml_mark_t& mark = event.start_mark;
    switch (event.type) {
      case YAML_DOCUMENT_START_EVENT:
        if (++documents_ < 2) return true;
        report_.add(place(mark), "", {"a second document begins here", "one document in a file", ""});
        return false;
      case YAML_ALIAS_EVENT:
        report_.add(place(mark), "",
                    {"aliases are not part of scene files", "the value itself (or `include:` to share parts)", ""});
        return false;
      case YAML_SCALAR_EVENT:
        take_scalar(event);
        return true;
      case YAML_SEQUENCE_START_EVENT:
        refuse_decoration(mark, event.data.sequence_start.anchor, event.data.sequence_start.tag);
        return open(Node::Kind::sequence, mark, event.data.sequence_start.style == YAML_FLOW_SEQUENCE_STYLE);
      case YAML_MAPPING_START_EVENT:
        refuse_decoration(mark, event.data.mapping_start.anchor, event.data.mapping_start.tag);
        return open(Node::Kind::map, mark, event.data.mapping_start.style == YAML_FLOW_MAPPING_STYLE);
      case YAML_SEQUENCE_END_EVENT:
      case YAML_MAPPING_END_EVENT:
        close(place(event.end_mark));
        return true;
      default:
        return true;
    }
  }

  [[nodiscard]] std::optional<Node>& root() { return root_; }

  void syntax_error(const yaml_parser_t& parser) {
    if (parser.error == YAML_READER_ERROR) {
      const std::size_t byte = std::min(parser.problem_offset, source_.text.size());
      report_.add(source_.mark_at(byte), "", {std::string("not valid YAML: ") + parser.problem, "UTF-8 text", ""});
      return;
    }
    const std::string_view context = parser.context == nullptr ? "" : parser.context;
    const std::size_t at = byte_of(parser.problem_mark);
    const char found = at < source_.text.size() ? source_.text[at] : '\0';
    const std::string begin = "not valid YAML: ";
    if (const std::optional<Mark> tab = tab_in_indentation(parser.problem_mark)) {
      report_.add(*tab, "", {begin + "the line is indented with a tab", "spaces", ""});
    } else if (context == "while scanning a quoted scalar" || context == "while parsing a quoted scalar") {
      explain_quote(parser, found == '\0');
    } else if (!open_.empty() && open_.back().is_in_brackets && context.starts_with("while parsing a flow")) {
      explain_brackets(place(parser.problem_mark), found);
    } else {
      report_.add(place(parser.problem_mark), "", explain(parser, place(parser.context_mark)));
    }
  }

 private:
  struct Open {
    Node node;
    bool is_in_brackets = false;
    bool has_key = false;      // map: a key waits for its value
    bool drops_value = false;  // there is no key
    std::string key;
    Mark key_mark;
  };

  [[nodiscard]] Mark place(const yaml_mark_t& mark) const {
    return {source_.source, static_cast<int>(mark.line) + 1, static_cast<int>(mark.column) + 1};
  }
  // text at a mark, which counts characters
  [[nodiscard]] std::size_t byte_of(const yaml_mark_t& mark) const { return source_.byte_of(place(mark)); }
  // the parser's messages in terms of the scene's author

  // an unclosed item is reported at its opening
  void explain_quote(const yaml_parser_t& parser, bool is_at_end) {
    const Mark opened = place(parser.context_mark);
    if (is_at_end) {
      const char quote = source_.text[byte_of(parser.context_mark)];
      report_.add(opened, "", {"this quote is not closed", std::string("a second ") + quote, ""});
    } else {
      report_.add(opened, "", {std::string("not valid YAML: ") + parser.problem, "UTF-8 text", ""});
    }
  }
  void explain_brackets(const Mark& mark, char found) {
    const Node& inner = open_.back().node;
    const bool is_list = inner.kind == Node::Kind::sequence;
    const char bracket = is_list ? '[' : '{';
    const std::string closing = is_list ? "']'" : "'}'";
    if (found == '\0') {
      report_.add(inner.mark, "", {fmt::format("this '{}' is not closed", bracket), closing + " or ','", ""});
    } else if (found == ']' || found == '}') {
      report_.add(
          mark, "",
          {fmt::format("not valid YAML: this bracket does not fit the '{}' in line {}", bracket, inner.mark.line),
           closing, ""});
    } else {
      report_.add(mark, "",
                  {fmt::format("not valid YAML: the '{}' in line {} goes on here", bracket, inner.mark.line),
                   closing + " or ','", ""});
    }
  }
  [[nodiscard]] static ValueProblem explain(const yaml_parser_t& parser, const Mark& opened) {
    const std::string begin = "not valid YAML: ", problem = parser.problem;
    if (problem == "mapping values are not allowed in this context" || problem == "could not find expected ':'") {
      return {begin + "no key can stand here", "one 'key: value' in a line; a ':' may be missing in the line before",
              ""};
    }
    if (problem == "did not find expected key") {
      return {fmt::format("{}this is no key of the map in line {}", begin, opened.line),
              "'key: value', indented like the other keys", ""};
    }
    return {begin + problem, "", ""};
  }
  // text of the line of a mark
  [[nodiscard]] std::optional<Mark> tab_in_indentation(const yaml_mark_t& mark) const {
    if (mark.line >= source_.line_start.size()) return std::nullopt;
    const std::size_t tab = source_.text.find_first_not_of(' ', source_.line_start[mark.line]);
    if (tab == std::string::npos || source_.text[tab] != '\t') return std::nullopt;
    return source_.mark_at(tab);
  }
  void refuse_decoration(const yaml_mark_t& mark, const yaml_char_t* anchor, const yaml_char_t* tag) {
    if (anchor != nullptr) {
      report_.add(place(mark), "",
                  {"anchors are not part of scene files", "the value itself (or `include:` to share parts)", ""});
    }
    if (tag != nullptr) {
      report_.add(place(mark), "", {"tags are not part of scene files", "the value without a '!'", ""});
    }
  }

  void take_scalar(const yaml_event_t& event) {
    const auto& scalar = event.data.scalar;
    refuse_decoration(event.start_mark, scalar.anchor, scalar.tag);
    Node node;
    node.mark = place(event.start_mark);
    node.end = place(event.end_mark);
    node.text.assign(reinterpret_cast<const char*>(scalar.value), scalar.length);
    if (has_expressions_) restore_signs(node.text);
    node.is_quoted = scalar.style != YAML_PLAIN_SCALAR_STYLE;
    if (!node.is_quoted && is_null(node.text)) {
      node.text.clear();
      accept(std::move(node));
      return;
    }
    node.kind = Node::Kind::scalar;
    // an escape may represent a character that the source must not contain
    std::string problem = text_problem(node.text);
    if (problem.empty()) problem = unprintable(node.text);
    if (!problem.empty()) {
      report_.add(node.mark, "", {std::move(problem) + " after its escapes are resolved", "UTF-8 text", ""});
    }
    accept(std::move(node));
  }

  bool open(Node::Kind kind, const yaml_mark_t& mark, bool is_in_brackets) {
    if (!open_.empty() && open_.back().node.kind == Node::Kind::map && !open_.back().has_key) {
      report_.add(place(mark), "", {"a list or map cannot be a key (is a bracket not closed?)", "a word", ""});
      return false;
    }
    if (open_.size() >= static_cast<std::size_t>(kMaxDepth)) {
      report_.add(place(mark), "", {"nested too deeply", "at most " + std::to_string(kMaxDepth) + " levels", ""});
      return false;
    }
    Open level;
    level.node.kind = kind;
    level.node.mark = place(mark);
    level.is_in_brackets = is_in_brackets;
    open_.push_back(std::move(level));
    return true;
  }
  void close(const Mark& end) {
    Node node = std::move(open_.back().node);
    // without brackets the parser reports the next token
    const bool is_in_brackets = open_.back().is_in_brackets;
    node.end = is_in_brackets ? end : node.kind == Node::Kind::map ? last_end(node.entries) : last_end(node.items);
    open_.pop_back();
    if (node.kind == Node::Kind::map) drop_duplicates(node);
    accept(std::move(node));
  }

  [[nodiscard]] static Mark last_end(const std::vector<Node::Entry>& entries) {
    return entries.empty() ? Mark{} : entries.back().value.end;
  }
  [[nodiscard]] static Mark last_end(const std::vector<Node>& items) {
    return items.empty() ? Mark{} : items.back().end;
  }

  // Moves a finished node to its place: the root, a list, a key or a key's value.
  void accept(Node node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& level = open_.back();
    if (level.node.kind == Node::Kind::sequence) {
      level.node.items.push_back(std::move(node));
    } else if (!level.has_key) {
      accept_key(level, node);
    } else {
      level.has_key = false;
      // a missing value is reported at its key
      if (node.kind == Node::Kind::empty) node.mark = level.key_mark;
      if (!level.drops_value) {
        level.node.entries.push_back({std::move(level.key), level.key_mark, std::move(node)});
      }
    }
  }
  void accept_key(Open& level, const Node& node) {
    level.has_key = true;
    level.drops_value = false;
    level.key = node.text;
    level.key_mark = node.mark;
    if (node.kind != Node::Kind::scalar || node.text.empty()) {
      report_.add(node.mark, "", {"the key is missing before ':'", "a word", ""});
      level.drops_value = true;
    }
  }

  // a key keeps its first value
  static void drop_duplicates(Node& map) {
    std::unordered_map<std::string_view, Mark> seen;
    const bool is_large = map.entries.size() > kFewEntries;
    const auto first_mark = [&](std::size_t i) {
      const Node::Entry& entry = map.entries[i];
      if (is_large) return seen.emplace(entry.key, entry.mark).first->second;
      std::size_t first = 0;
      while (map.entries[first].key != entry.key) ++first;
      return map.entries[first].mark;
    };
    std::vector<bool> is_dropped(map.entries.size());
    for (std::size_t i = 0; i < map.entries.size(); ++i) {
      const Node::Entry& entry = map.entries[i];
      const Mark first = first_mark(i);
      if (first == entry.mark) continue;
      map.duplicates.push_back({entry.key, entry.mark, first});
      is_dropped[i] = true;
    }
    if (map.duplicates.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < is_dropped.size(); ++i) {
      if (!is_dropped[i]) std::swap(map.entries[kept++], map.entries[i]);
    }
    map.entries.erase(map.entries.begin() + static_cast<std::ptrdiff_t>(kept), map.entries.end());
  }

  const SourceText& source_;
  Report& report_;
  const bool has_expressions_;
  int documents_ = 0;
  std::vector<Open> open_;
  std::optional<Node> root_;
};

class Parser {
 public:
  explicit Parser(const std::string& text) {
    if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()), text.size());
    yaml_parser_set_encoding(&parser_, YAML_UTF8_ENCODING);
  }
  ~Parser() { yaml_parser_delete(&parser_); }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  enum class End { none, of_text, syntax_error, refused };
  // Takes the next event.
  End advance(TreeBuilder& builder) {
    struct Event : yaml_event_t {
      ~Event() { yaml_event_delete(this); }
    } event;
    if (yaml_parser_parse(&parser_, &event) == 0) {
      if (parser_.error == YAML_MEMORY_ERROR) throw std::bad_alloc();
      return End::syntax_error;
    }
    if (event.type == YAML_STREAM_END_EVENT) return End::of_text;
    return builder.take(event) ? End::none : End::refused;
  }
  [[nodiscard]] const yaml_parser_t& state() const { return parser_; }

 private:
  yaml_parser_t parser_;
};

std::optional<Node> read_document(const SourceText& source, Report& report) {
  for (const std::string_view odd : kOddBreaks) {
    const std::size_t at = source.text.find(odd);
    if (at == std::string::npos) continue;
    report.add(source.mark_at(at), "",
               {"a line break that no editor shows (U+0085, U+2028 or U+2029)", "a line feed", ""});
    return std::nullopt;
  }
  const std::string hidden = without_signs(source.text);
  const std::size_t odd = hidden.empty() ? std::string::npos : source.text.find(kSignPlane);
  if (odd != std::string::npos) {
    report.add(source.mark_at(odd), "",
               {"a character of the private plane U+F0000 in a file with expressions", "another character", ""});
    return std::nullopt;
  }
  using Expressions = TreeBuilder::Expressions;
  Parser parser(hidden.empty() ? source.text : hidden);
  TreeBuilder builder(source, hidden.empty() ? Expressions::none : Expressions::hidden, report);
  const std::size_t problems = report.size();
  Parser::End end = Parser::End::none;
  while (end == Parser::End::none) end = parser.advance(builder);
  if (end == Parser::End::syntax_error) builder.syntax_error(parser.state());
  if (end != Parser::End::of_text) return std::nullopt;
  if (!builder.root() && report.size() == problems) {
    report.add({source.source, 1, 1}, "", {"the file is empty", "a scene", ""});
  }
  return std::move(builder.root());
}

}  // namespace

const Node::Entry* Node::find(std::string_view key) const {
  for (const Entry& entry : entries) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

Node::Entry* Node::find(std::string_view key) {
  return const_cast<Entry*>(std::as_const(*this).find(key));
}

std::string describe(const Node& node) {
  switch (node.kind) {
    case Node::Kind::empty:
      return "nothing";
    case Node::Kind::sequence:
      return node.items.empty() ? "an empty list" : "a list";
    case Node::Kind::map:
      return "a map";
    case Node::Kind::scalar:
      break;
  }
  return fmt::format("'{}'", printable(shortened(node.text)));
}

std::optional<Node> parse_yaml(const SourceText& source, Report& report) {
  std::optional<Node> root = read_document(source, report);
  if (!root) return std::nullopt;
  if (root->kind == Node::Kind::empty) {
    report.add({source.source, 1, 1}, "", {"the file is empty", "a scene", ""});
    return std::nullopt;
  }
  if (root->kind != Node::Kind::map) {
    report.add(root->mark, "", {"the file holds " + describe(*root), "sections such as 'bodies:'", ""});
    return std::nullopt;
  }
  return root;
}

}  // namespace slew::scene
