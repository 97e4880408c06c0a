// SPDX-License-Identifier: Apache-2.0
#include "devices/dbc.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "core/input_file.h"
#include "core/printable.h"
#include "devices/dbc_tokens.h"

namespace slew::devices {
namespace {

constexpr std::size_t kMaxProblems = 20;
constexpr std::uint32_t kExtendedFlag = 0x80000000;
constexpr std::uint32_t kNoMessage = 0xC0000000;  // holder of signals without a message: VECTOR__INDEPENDENT_SIG_MSG

// A problem of the statement at hand; caught at its begin.
struct DbcError {
  int line;
  std::string what, expected;
};

class DbcReader {
 public:
  DbcReader(std::string_view text, std::string_view name, Problems& problems)
      : tokens_(dbc_tokens(text)), name_(name), problems_(problems) {}

  CanDatabase read() {
    while (now().kind != DbcTokenKind::end && found_ < kMaxProblems) {
      const std::size_t begin = at_;
      try {
        statement();
      } catch (const DbcError& error) {
        add_problem(error.line, error.what, error.expected);
        is_message_broken_ = true;
        at_ = std::max(at_, begin + 1);
        skip_to_statement();
      }
    }
    finish_message();
    apply_value_types();
    apply_selections();
    check_messages();
    return std::move(database_);
  }

 private:
  struct Placed {
    int line = 0;
    std::map<std::string, int, std::less<>> signal_lines;
  };
  struct ValueType {
    int line;
    std::uint32_t id;
    std::string signal;
    CanNumber number;
  };
  struct Selection {
    int line;
    std::uint32_t id;
    std::string signal, selector;
    std::vector<SelectorRange> ranges;
  };

  // --- tokens
  [[nodiscard]] const DbcToken& now() const { return tokens_[at_]; }
  static bool is_signal_keyword(const DbcToken& token) {
    return token.kind == DbcTokenKind::word && token.text == "SG_";
  }
  // SG_ is indented, all others begin a line
  static bool begins_statement(const DbcToken& token) {
    return token.kind == DbcTokenKind::word && (token.begins_line || is_signal_keyword(token));
  }
  void skip_to_statement() {
    while (now().kind != DbcTokenKind::end && !begins_statement(now())) ++at_;
  }
  DbcToken take(DbcTokenKind kind, std::string_view what) {
    const DbcToken token = now();
    if (token.kind != kind) throw unexpected(what);
    ++at_;
    return token;
  }
  void take_sign(std::string_view sign) {
    if (now().kind != DbcTokenKind::sign || now().text != sign) throw unexpected(fmt::format("'{}'", sign));
    ++at_;
  }
  [[nodiscard]] DbcError unexpected(std::string_view expected) const {
    if (now().kind == DbcTokenKind::broken) return {now().line, std::string(now().text), "a closing quote"};
    if (now().kind == DbcTokenKind::end) return {now().line, "the file ends within a statement", std::string(expected)};
    return {now().line, fmt::format("'{}' is not expected here", printable(now().text)), std::string(expected)};
  }
  template <typename T>
  T take_number(std::string_view what) {
    const DbcToken token = take(DbcTokenKind::number, what);
    std::string_view digits = token.text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      throw DbcError{token.line, fmt::format("'{}' is out of range or malformed", token.text), std::string(what)};
    }
    return value;
  }
  void add_problem(int line, std::string what, std::string expected) {
    if (found_++ < kMaxProblems) {
      problems_.push_back({fmt::format("{}:{}", name_, line), std::move(what), std::move(expected), ""});
    }
  }

  // --- statements
  void statement() {
    const DbcToken keyword = take(DbcTokenKind::word, "a keyword, as BO_");
    if (keyword.text == "SG_") return signal(keyword);
    finish_message();
    if (keyword.text == "BO_") return message(keyword);
    if (keyword.text == "SIG_VALTYPE_") return value_type(keyword);
    if (keyword.text == "SG_MUL_VAL_") return selection(keyword);
    if (keyword.text == "VERSION") return static_cast<void>(take(DbcTokenKind::text, "the version as a text"));
    // lists without an end of their own
    if (keyword.text == "NS_" || keyword.text == "BU_" || keyword.text == "BS_") {
      return skip_to_statement();
    }
    skip(keyword);
  }

  // Any other section: to its semicolon, which must come before the next statement.
  void skip(const DbcToken& keyword) {
    ++database_.skipped[std::string(keyword.text)];
    while (now().kind != DbcTokenKind::sign || now().text != ";") {
      if (now().kind == DbcTokenKind::end || now().kind == DbcTokenKind::broken || now().begins_line) {
        throw DbcError{keyword.line, fmt::format("section {} has no end", printable(keyword.text)), "';'"};
      }
      ++at_;
    }
    ++at_;
  }

  void message(const DbcToken& keyword) {
    const auto id = take_number<std::uint32_t>("the message's number");
    CanMessage message;
    message.name = take(DbcTokenKind::word, "the message's name").text;
    take_sign(":");
    message.bytes = take_number<std::uint32_t>("the message's size in bytes");
    static_cast<void>(take(DbcTokenKind::word, "the sending node"));
    message.is_extended = (id & kExtendedFlag) != 0;
    message.id = id & ~kExtendedFlag;
    has_message_ = true;
    is_holder_ = id == kNoMessage;
    is_message_broken_ = false;
    place_ = {keyword.line, {}};
    message_ = std::move(message);
  }

  void signal(const DbcToken& keyword) {
    if (!has_message_ && is_message_broken_) return skip_to_statement();  // reported already
    if (!has_message_) throw DbcError{keyword.line, "a signal without a message", "BO_ before SG_"};
    CanSignal signal;
    signal.name = take(DbcTokenKind::word, "the signal's name").text;
    if (now().kind == DbcTokenKind::word) multiplexing(signal);
    take_sign(":");
    signal.start_bit = take_number<std::uint16_t>("the start bit");
    take_sign("|");
    signal.bits = take_number<std::uint16_t>("the number of bits");
    take_sign("@");
    const auto order = take_number<unsigned>("0 (Motorola) or 1 (Intel)");
    if (order > 1) throw DbcError{keyword.line, fmt::format("byte order {}", order), "0 (Motorola) or 1 (Intel)"};
    signal.order = order == 0 ? ByteOrder::big : ByteOrder::little;
    const DbcToken sign = take(DbcTokenKind::sign, "+ (unsigned) or - (signed)");
    if (sign.text != "+" && sign.text != "-") throw DbcError{sign.line, "no sign", "+ (unsigned) or - (signed)"};
    signal.is_signed = sign.text == "-";
    take_sign("(");
    signal.scale = take_number<double>("the factor");
    take_sign(",");
    signal.offset = take_number<double>("the offset");
    take_sign(")");
    take_sign("[");
    signal.lowest = take_number<double>("the lowest value");
    take_sign("|");
    signal.highest = take_number<double>("the highest value");
    take_sign("]");
    signal.unit = take(DbcTokenKind::text, "the unit as a text").text;
    skip_to_statement();  // receiving nodes
    place_.signal_lines.emplace(signal.name, keyword.line);
    message_.signals.push_back(std::move(signal));
  }

  // M, m3
  void multiplexing(CanSignal& signal) {
    const DbcToken token = take(DbcTokenKind::word, "M or m0");
    if (token.text == "M") {
      signal.is_selector = true;
      return;
    }
    const std::string_view digits = token.text.substr(1);
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (token.text[0] == 'm' && error == std::errc() && end == digits.data() + digits.size() - 1 && *end == 'M') {
      throw DbcError{token.line, fmt::format("'{}' is a multiplexer below another one", token.text),
                     "one level, M and m0"};
    }
    if (token.text[0] != 'm' || error != std::errc() || end != digits.data() + digits.size()) {
      throw DbcError{token.line, fmt::format("'{}' is no multiplexing", printable(token.text)), "M or m0"};
    }
    signal.selected_by = {{number, number}};
  }

  // SIG_VALTYPE_ 100 Speed : 1;
  void value_type(const DbcToken& keyword) {
    ValueType type{keyword.line, take_number<std::uint32_t>("the message's number"), "", CanNumber::integer};
    type.signal = take(DbcTokenKind::word, "the signal's name").text;
    if (now().text == ":") ++at_;
    const auto number = take_number<unsigned>("0 (integer), 1 (float) or 2 (double)");
    if (number > 2) throw DbcError{keyword.line, fmt::format("value type {}", number), "0, 1 or 2"};
    type.number = static_cast<CanNumber>(number);
    take_sign(";");
    value_types_.push_back(std::move(type));
  }

  // SG_MUL_VAL_ 100 Pressure Selector 0-3, 7-7;
  void selection(const DbcToken& keyword) {
    Selection selection{keyword.line, take_number<std::uint32_t>("the message's number"), "", "", {}};
    selection.signal = take(DbcTokenKind::word, "the signal's name").text;
    selection.selector = take(DbcTokenKind::word, "the multiplexer's name").text;
    for (;;) {
      SelectorRange range;
      range.first = take_number<std::uint64_t>("a number of the multiplexer");
      range.last = take_range_end();
      if (range.last < range.first) throw DbcError{keyword.line, "a range that ends before its begin", "0-3"};
      selection.ranges.push_back(range);
      if (now().text != ",") break;
      ++at_;
    }
    take_sign(";");
    selections_.push_back(std::move(selection));
  }

  // the "-3" of "0-3", with blanks or without
  std::uint64_t take_range_end() {
    if (now().kind == DbcTokenKind::sign && now().text == "-") {
      ++at_;
      return take_number<std::uint64_t>("the last number of the range");
    }
    if (now().kind != DbcTokenKind::number || !now().text.starts_with('-')) throw unexpected("a range, as 0-3");
    const auto last = take_number<std::int64_t>("the last number of the range");
    return static_cast<std::uint64_t>(-last);
  }

  // --- whole messages
  void finish_message() {
    if (has_message_ && !is_holder_ && !is_message_broken_) {
      database_.messages.push_back(std::move(message_));
      places_.push_back(std::move(place_));
    } else if (has_message_ && is_holder_) {
      ++database_.skipped[message_.name];
    }
    has_message_ = false;
  }

  CanSignal* find(int line, std::uint32_t id, std::string_view name) {
    if (id == kNoMessage) return nullptr;
    for (CanMessage& m : database_.messages) {
      if (m.id != (id & ~kExtendedFlag) || m.is_extended != ((id & kExtendedFlag) != 0)) continue;
      if (const auto i = find_signal(m, name)) return &m.signals[*i];
    }
    if (found_ == 0) add_problem(line, fmt::format("message {} has no signal '{}'", id, name), "a signal of the file");
    return nullptr;
  }

  void apply_value_types() {
    for (const ValueType& type : value_types_) {
      if (CanSignal* s = find(type.line, type.id, type.signal)) s->number = type.number;
    }
  }

  void apply_selections() {
    for (const Selection& selection : selections_) {
      CanSignal* s = find(selection.line, selection.id, selection.signal);
      const CanSignal* selector = find(selection.line, selection.id, selection.selector);
      if (s == nullptr || selector == nullptr) continue;
      if (!selector->is_selector) {
        add_problem(selection.line, fmt::format("'{}' is no multiplexer M", selection.selector), "one level, M and m0");
      } else {
        s->selected_by = selection.ranges;
      }
    }
  }

  void check_messages() {
    std::set<std::pair<std::uint32_t, bool>> ids;
    std::set<std::string> names;
    std::vector<CanMessage> sound;
    for (std::size_t i = 0; i < database_.messages.size(); ++i) {
      CanMessage& m = database_.messages[i];
      const Placed& place = places_[i];
      Problems found;
      validate("", m, found);
      for (Problem& problem : found) {
        const std::string signal = problem.path.substr(1);
        const auto line = place.signal_lines.find(signal);
        const std::string owner = line == place.signal_lines.end() ? m.name : m.name + "." + signal;
        add_problem(line == place.signal_lines.end() ? place.line : line->second, owner + ": " + problem.what,
                    problem.expected);
      }
      if (!ids.insert({m.id, m.is_extended}).second || !names.insert(m.name).second) {
        add_problem(place.line, fmt::format("message {}: its number or its name is used twice", m.name), "");
      } else if (found.empty()) {
        sound.push_back(std::move(m));
      }
    }
    database_.messages = std::move(sound);
  }

  std::vector<DbcToken> tokens_;
  std::string name_;
  Problems& problems_;
  std::size_t at_ = 0;
  std::size_t found_ = 0;
  CanDatabase database_;
  std::vector<Placed> places_;
  std::vector<ValueType> value_types_;
  std::vector<Selection> selections_;
  CanMessage message_;  // at hand
  Placed place_;
  bool has_message_ = false, is_holder_ = false, is_message_broken_ = false;
};

}  // namespace

CanDatabase read_dbc(std::string_view text, std::string_view name, Problems& problems) {
  const std::string utf8 = dbc_text(text);
  return DbcReader(utf8, name, problems).read();
}

CanDatabase load_dbc(const std::filesystem::path& path, Problems& problems) {
  std::string bytes;
  if (const auto fault = read_input(path, kMaxDbcBytes, bytes)) {
    problems.push_back({path.string(), fault->what, fault->expected.empty() ? "a DBC file" : fault->expected, ""});
    return {};
  }
  return read_dbc(bytes, path.filename().string(), problems);
}

const CanMessage* find_message(const CanDatabase& database, std::string_view name) noexcept {
  for (const CanMessage& message : database.messages) {
    if (message.name == name) return &message;
  }
  return nullptr;
}

const CanMessage* find_message(const CanDatabase& database, std::uint32_t id, bool is_extended) noexcept {
  for (const CanMessage& message : database.messages) {
    if (message.id == id && message.is_extended == is_extended) return &message;
  }
  return nullptr;
}

}  // namespace slew::devices
