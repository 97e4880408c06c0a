// SPDX-License-Identifier: Apache-2.0
#include "options/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace slew::options {
namespace {

// Text for roff: no escape sequences, no requests, hyphens that can be copied as options.
std::string escaped(const std::string& text) {
  std::string result;
  bool is_at_start = true;
  for (const char c : text) {
    if (is_at_start && (c == '.' || c == '\'')) result += "\\&";
    is_at_start = c == '\n';
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else if (c == '\'') {
      result += "\\(aq";
    } else {
      result += c;
    }
  }
  return result;
}

std::string bold(const std::string& text) {
  return "\\fB" + escaped(text) + "\\fP";
}

std::string italic(const std::string& text) {
  return "\\fI" + escaped(text) + "\\fP";
}

std::string dashed(std::string words) {
  std::replace(words.begin(), words.end(), ' ', '-');
  return words;
}

// "[OPTIONS] SCENE [NAME...]"
std::string synopsis(const CommandText& command, const std::string& words) {
  std::string line = bold(words) + " [" + italic("OPTIONS") + "]";
  for (const OptionText& option : command.options) {
    if (!option.is_positional) continue;
    const std::string name = italic(option.names[0]) + (option.takes_many ? "..." : "");
    line += option.is_required ? " " + name : " [" + name + "]";
  }
  if (!command.commands.empty()) line += " " + italic("COMMAND") + " ...";
  return line;
}

std::string option_entry(const OptionText& option) {
  std::string head;
  for (const std::string& name : option.names) {
    head += (head.empty() ? "" : ", ") + (option.is_positional ? italic(name) : bold(name));
  }
  if (!option.value_name.empty() && !option.is_positional) head += " " + italic(option.value_name);
  std::string body = escaped(option.description);
  const auto add = [&body](const std::string& what, const std::string& text) {
    if (!text.empty()) body += fmt::format("\n.br\n{}: {}", what, escaped(text));
  };
  add("One of", fmt::format("{}", fmt::join(option.choices, ", ")));
  add("Accepted", option.range);
  add("Default", option.default_text == "\"\"" ? "" : option.default_text);
  add("Environment", option.environment);
  return fmt::format(".TP\n{}\n{}\n", head, body);
}

// The headings in the order of --help, CLI11's first one being "Options".
std::vector<std::string> groups_of(const CommandText& command) {
  std::vector<std::string> groups;
  for (const OptionText& option : command.options) {
    const bool is_new = std::find(groups.begin(), groups.end(), option.group) == groups.end();
    if (!option.is_positional && is_new) groups.push_back(option.group);
  }
  return groups;
}

std::string option_list(const CommandText& command) {
  std::string text;
  for (const OptionText& option : command.options) {
    if (option.is_positional) text += option_entry(option);
  }
  for (const std::string& group : groups_of(command)) {
    if (group != "Options") text += fmt::format(".PP\n{}\n", bold(group + ":"));
    for (const OptionText& option : command.options) {
      if (!option.is_positional && option.group == group) text += option_entry(option);
    }
  }
  return text;
}

// Paragraphs of a footer; the one that begins with "Example" keeps its lines.
std::string footer(const std::string& text) {
  std::string result;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find("\n\n", begin), text.size());
    const std::string paragraph = text.substr(begin, end - begin);
    const bool is_example = paragraph.starts_with("Example");
    result += is_example ? fmt::format(".PP\n.nf\n{}\n.fi\n", escaped(paragraph))
                         : fmt::format(".PP\n{}\n", escaped(paragraph));
    begin = end + 2;
  }
  return result;
}

// A heading begins a paragraph by itself.
std::string section(const std::string& heading, const std::string& body) {
  constexpr std::string_view kParagraph = ".PP\n";
  return ".SH " + heading + "\n" + body.substr(body.starts_with(kParagraph) ? kParagraph.size() : 0);
}

// The verbs below a verb, each with its options.
std::string sections_below(const CommandText& command, const std::string& words) {
  std::string text;
  for (const CommandText& verb : command.commands) {
    const std::string own = words + " " + verb.name;
    text += fmt::format(".SS \"{}\"\n{}\n.PP\n{}\n{}{}", escaped(own), synopsis(verb, own), escaped(verb.description),
                        option_list(verb), footer(verb.footer));
    text += sections_below(verb, own);
  }
  return text;
}

std::string page(const CommandText& command, const std::string& words, const std::string& version,
                 const std::string& below, const std::string& see_also) {
  const std::string name = dashed(words);
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  // no date: the same sources give the same page
  std::string text = fmt::format(".TH \"{}\" \"1\" \"\" \"Slewring {}\" \"Slewring\"\n", escaped(title), version);
  text += fmt::format(".SH NAME\n{} \\- {}\n", escaped(name), escaped(command.description));
  text += fmt::format(".SH SYNOPSIS\n{}\n", synopsis(command, words));
  text += section("OPTIONS", option_list(command));
  text += below;
  if (!command.footer.empty()) text += section("NOTES", footer(command.footer));
  if (!see_also.empty()) text += ".SH SEE ALSO\n" + see_also + "\n";
  return text;
}

std::string reference(const std::string& name) {
  return fmt::format("\\fB{}\\fP(1)", escaped(name));
}

}  // namespace

std::vector<ManualPage> manual_pages(const CommandText& program, const std::string& version) {
  std::vector<ManualPage> pages;
  std::string verbs;
  std::vector<std::string> references;
  for (const CommandText& verb : program.commands) {
    const std::string words = program.name + " " + verb.name;
    const std::string below = verb.commands.empty() ? "" : section("COMMANDS", sections_below(verb, words));
    pages.push_back({dashed(words), page(verb, words, version, below, reference(program.name))});
    verbs += fmt::format(".TP\n{}\n{}\n", bold(verb.name), escaped(verb.description));
    references.push_back(reference(dashed(words)));
  }
  const std::string below = verbs.empty() ? "" : section("COMMANDS", verbs);
  pages.push_back(
      {program.name, page(program, program.name, version, below, fmt::format("{}", fmt::join(references, ",\n")))});
  return pages;
}

}  // namespace slew::options
