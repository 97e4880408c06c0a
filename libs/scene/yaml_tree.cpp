#include "scene/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <functional>
#include <map>
#include <sstream>
#include <utility>

#include "core/printable.h"

namespace slew::scene {
namespace {

// leaves yaml-cpp after a problem that makes the rest meaningless; never leaves this file
struct StopReading {};

constexpr std::size_t kLongestQuote = 40;

std::string shortened(const std::string& text) {
  if (text.size() <= kLongestQuote) return text;
  // not in the middle of a character
  std::size_t end = kLongestQuote;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

// Position of the byte behind the closing quote of the scalar that opens at `open`; npos when there is none.
std::size_t closing_quote(std::string_view text, std::size_t open) {
  const char quote = text[open];
  for (std::size_t i = open + 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '\'' && i + 1 < text.size() && text[i + 1] == '\'') {
        ++i;
      } else {
        return i + 1;
      }
    }
  }
  return std::string_view::npos;
}

class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const SourceText& source, Report& report) : source_(source), report_(report), marks_(source) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ < 2) return;
    report_.add(place(mark), "", {"a second document begins here", "one document in a file", ""});
    throw StopReading();
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    Node node;
    node.mark = place(mark);
    accept(std::move(node));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse_alias(place(mark));
    throw StopReading();
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    const auto at = static_cast<std::size_t>(std::max(mark.pos, 0));
    const char first = at < source_.text.size() ? source_.text[at] : '\0';
    const bool has_tag = tag != "?" && (tag != "!" || first == '!');
    if (has_tag) refuse_tag(mark);
    if ((first == '"' || first == '\'') && closing_quote(source_.text, at) == std::string_view::npos) {
      report_.add(place(mark), "", {"this quote is not closed", std::string("a second ") + first, ""});
      throw StopReading();
    }
    // an escape may stand for what the source itself must not hold
    if (std::string problem = text_problem(value); !problem.empty()) {
      report_.add(place(mark), "", {std::move(problem) + " after its escapes are resolved", "UTF-8 text", ""});
    }
    Node node;
    node.kind = Node::Kind::scalar;
    node.is_quoted = tag != "?" && !has_tag;
    node.text = value;
    node.mark = place(mark);
    accept(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Node::Kind::sequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Node::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { close(); }

  [[nodiscard]] std::optional<Node>& root() { return root_; }

  void syntax_error(const YAML::Exception& error) {
    if (error.msg == "the referenced anchor is not defined") {
      refuse_alias(place(error.mark));
      return;
    }
    // a bracket that was never closed is best shown where it opened
    if (error.msg.find("flow not found") != std::string::npos && !open_.empty()) {
      const Node& inner = open_.back().node;
      const bool is_list = inner.kind == Node::Kind::sequence;
      report_.add(inner.mark, "",
                  {std::string("this '") + (is_list ? '[' : '{') + "' is not closed",
                   std::string("'") + (is_list ? ']' : '}') + "' or ','", ""});
      return;
    }
    report_.add(place(error.mark), "", explain(error));
  }

 private:
  struct Open {
    Node node;
    bool has_key = false;      // map: a key waits for its value
    bool drops_value = false;  // the key was refused
    std::string key;
    Mark key_mark;
    std::map<std::string, Mark, std::less<>> seen;
  };

  [[nodiscard]] Mark place(const YAML::Mark& mark) {
    if (mark.is_null()) return {source_.source, 0, 0};
    return marks_.mark_at(std::min(static_cast<std::size_t>(std::max(mark.pos, 0)), source_.text.size()));
  }
  // yaml-cpp's messages in the words of somebody who writes a scene
  [[nodiscard]] Complaint explain(const YAML::Exception& error) {
    const std::string begin = "not valid YAML: ";
    if (line_begins_with_tab(place(error.mark))) return {begin + "the line is indented with a tab", "spaces", ""};
    if (error.msg == "illegal flow end" && !open_.empty()) {
      const Node& inner = open_.back().node;
      const char bracket = inner.kind == Node::Kind::sequence ? '[' : '{';
      return {fmt::format("{}this bracket does not fit the '{}' in line {}", begin, bracket, inner.mark.line),
              bracket == '[' ? "']'" : "'}'", ""};
    }
    if (error.msg == "illegal map value") {
      return {begin + "no key can stand here", "one 'key: value' in a line; a ':' may be missing in the line before",
              ""};
    }
    return {begin + error.msg, "", ""};
  }
  [[nodiscard]] bool line_begins_with_tab(const Mark& mark) const {
    if (mark.line < 1) return false;
    std::size_t i = source_.line_start[static_cast<std::size_t>(mark.line) - 1];
    while (i < source_.text.size() && source_.text[i] == ' ') ++i;
    return i < source_.text.size() && source_.text[i] == '\t';
  }
  void refuse_alias(const Mark& mark) {
    report_.add(mark, "",
                {"aliases are not part of scene files", "the value itself (or `include:` to share parts)", ""});
  }
  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor == 0) return;
    report_.add(place(mark), "",
                {"anchors are not part of scene files", "the value itself (or `include:` to share parts)", ""});
  }
  void refuse_tag(const YAML::Mark& mark) {
    report_.add(place(mark), "", {"tags are not part of scene files", "the value without a '!'", ""});
  }

  void open(Node::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    refuse_anchor(mark, anchor);
    if (!tag.empty() && tag != "?") refuse_tag(mark);
    if (!open_.empty() && open_.back().node.kind == Node::Kind::map && !open_.back().has_key) {
      report_.add(place(mark), "", {"a list or map cannot be a key (is a bracket not closed?)", "a word", ""});
      throw StopReading();
    }
    if (open_.size() >= static_cast<std::size_t>(kMaxDepth)) {
      report_.add(place(mark), "", {"nested too deeply", "at most " + std::to_string(kMaxDepth) + " levels", ""});
      throw StopReading();
    }
    Open level;
    level.node.kind = kind;
    level.node.mark = place(mark);
    open_.push_back(std::move(level));
  }
  void close() {
    Node node = std::move(open_.back().node);
    open_.pop_back();
    accept(std::move(node));
  }

  // A finished node goes to where it belongs: the root, a list, a key or a key's value.
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
      // a value that is not there is shown at its key
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
      return;
    }
    const auto [first, is_new] = level.seen.emplace(node.text, node.mark);
    if (!is_new) {
      level.node.duplicates.push_back({node.text, node.mark, first->second});
      level.drops_value = true;
    }
  }

  const SourceText& source_;
  Report& report_;
  MarkCursor marks_;
  int documents_ = 0;
  std::vector<Open> open_;
  std::optional<Node> root_;
};

std::optional<Node> read_document(const SourceText& source, Report& report) {
  std::istringstream stream(source.text);
  TreeBuilder builder(source, report);
  const std::size_t problems = report.size();
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const StopReading&) {
    return std::nullopt;
  } catch (const YAML::Exception& error) {
    builder.syntax_error(error);
    return std::nullopt;
  }
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
      return "a list";
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
