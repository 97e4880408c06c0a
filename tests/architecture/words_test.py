#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds words of people's talk where programs are meant: in comments, texts and names of C++, in comments and texts of
TypeScript, and in documents.

words_test.py ROOT [PATH ...]: files or folders below ROOT; all tracked kinds of file without paths. Prints file:line: word.
words_test.py ROOT --width [PATH ...]: finds lines of prose in documents that are longer than WIDTH characters instead.
The glossary in docs/notation.md has the words to use: publish, report, receive, request, resend, acknowledge, reject.
"""
import os
import re
import sys

WORDS = re.compile(
    r"(?<!-)\b(say|says|said|saying|tell|tells|told|telling|hear|hears|heard|hearing|nobody|somebody|anybody|everybody"
    r"|knows|know|knew|knowing|asks|ask|asked|asking|anew|wish|wishes|wished)\b|(?<!\w)who\b",
    re.IGNORECASE,
)
# The same in names of C++, word by word. Two words are not in it: idl/slewring.idl has them as names of its contract.
WORDS_OF_NAMES = re.compile(
    r"say|says|said|saying|tell|tells|told|telling|hear|hears|hearing|nobody|somebody|anybody|everybody|knows|know|knew"
    r"|knowing|ask|asks|asking|anew|wish|wishes|wished|who|news",
    re.IGNORECASE,
)
# people may do it, programs may not
PEOPLE = re.compile(
    r"\b(users?|engineers?|designers?|trainers?|drivers?|operators?|readers?|people|person|those|anyone|everyone|you)"
    r"(,? and \w+)? who\b",
    re.IGNORECASE,
)
# keys and values of JSON documents, which programs read
CONTRACTS = ('"not heard"', '"heard"', '"asked"')
WIDTH = 120  # tables, code and a line that is one link may be longer
ONE_LINK = re.compile(r"\s*([-*+] |\d+\. )?!?\[[^]]*\](\([^)]*\)|: *\S+)[.,;:]?")
SKIPPED = ("tests/scenes_negative", "tests/fuzz/corpus", "build", ".git", "docs/references.bib")


# comments, literals and includes
NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"\w*\(.*?\)\w*"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])+\'|#include[^\n]*', re.S)


def without_digit_separators(source):
    return re.sub(r"(?<=[0-9a-fA-F])'(?=[0-9a-fA-F])", "_", source)  # they are no character literals


def texts_of_cpp(source):
    """Comments and string literals, with their lines."""
    source = without_digit_separators(source)
    for match in NO_CODE.finditer(source):
        if not match[0].startswith(("#include", "'")) and match[0] not in CONTRACTS:
            yield source.count("\n", 0, match.start()) + 1, match[0]


def names_of_cpp(source):
    """Names, with their lines."""
    code = NO_CODE.sub(lambda match: "\n" * match[0].count("\n") or " ", without_digit_separators(source))
    for number, line in enumerate(code.split("\n"), 1):
        for name in re.findall(r"[A-Za-z_]\w*", line):
            yield number, name


def lines_of_markdown(source):
    """Lines outside of code, with their numbers."""
    is_code = False
    for number, line in enumerate(source.split("\n"), 1):
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code and not line.startswith("    "):
            yield number, line


def texts_of_markdown(source):
    for number, line in lines_of_markdown(source):
        yield number, re.sub(r"`[^`]*`|\]\([^)]*\)", "", line)


def comments_after_hash(source):
    for number, line in enumerate(source.split("\n"), 1):
        if comment := re.search(r"(?:^|\s)#(.*)", line):
            yield number, comment[1]


READERS = {".cpp": texts_of_cpp, ".h": texts_of_cpp, ".idl": texts_of_cpp, ".ts": texts_of_cpp, ".mjs": texts_of_cpp,
           ".md": texts_of_markdown, ".yaml": comments_after_hash, ".cmake": comments_after_hash, ".py": comments_after_hash,
           ".sh": comments_after_hash, ".txt": comments_after_hash}


def findings(path):
    with open(path, encoding="utf-8") as file:
        source = file.read()
    for number, text in READERS[os.path.splitext(path)[1]](source):
        for match in WORDS.finditer(PEOPLE.sub("", text)):
            yield number + text.count("\n", 0, match.start()), match[0]
    if path.endswith((".cpp", ".h")):
        for number, name in names_of_cpp(source):
            if any(WORDS_OF_NAMES.fullmatch(word) for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)):
                yield number, name


def long_lines(path):
    if not path.endswith(".md"):
        return
    with open(path, encoding="utf-8") as file:
        source = file.read()
    for number, line in lines_of_markdown(source):
        if len(line) > WIDTH and not line.lstrip().startswith("|") and not ONE_LINK.fullmatch(line):
            yield number, f"{len(line)} characters, expected at most {WIDTH}: wrap the line"


def files_below(root, path):
    full = os.path.join(root, path)
    if os.path.isfile(full):
        yield full
    for folder, folders, names in os.walk(full):
        folders[:] = [f for f in folders if not os.path.relpath(os.path.join(folder, f), root).startswith(SKIPPED)]
        for name in names:
            if os.path.splitext(name)[1] in READERS:
                yield os.path.join(folder, name)


def main():
    root, paths = sys.argv[1], sys.argv[2:]
    find = findings
    if paths[:1] == ["--width"]:
        find, paths = long_lines, paths[1:]
    count = 0
    for path in paths or ["."]:
        files = sorted(files_below(root, path))
        if not files:
            print(f"{path}: no file to read; expected files or folders below {root}")
            count += 1
        for file in files:
            for number, finding in find(file):
                print(f"{os.path.relpath(file, root)}:{number}: {finding}")
                count += 1
    sys.exit(1 if count else 0)


if __name__ == "__main__":
    main()
