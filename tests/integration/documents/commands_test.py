#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The commands of README, tutorials and how-tos do what the documents print.

  commands_test.py SOURCE_TREE BUILD_FOLDER list           every command is run or has a reason; options exist
  commands_test.py SOURCE_TREE BUILD_FOLDER run DOCUMENT   runs the commands of one document, in their order

A command is a line of a code block that begins with "$ ". commands.toml states, by regular expressions that match from
the command's first letter, which ones are not run and why, which ones stay in the background until the document's
next session or its end, and which ones are changed: other options, since the test has less time than a reader; a scene
that the document prints (the block that holds a text) as a file; a shell line before it; another exit code.
Lines printed below a command are compared where their beginning is one of kCompared: computed values and refusals.
"""
import os, pathlib, re, shutil, signal, subprocess, sys, tempfile, time, tomllib

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from domains import take_domain  # noqa: E402

kCompared = re.compile(r"range  |note  |motions  |merged  |ports  |inputs  |inertia  |equal bit for bit|slewring: refused|"
                       r"largest liftable|limited by|\d+ (?:kept|dropped)  |\d+ modes: |modes 1 to|lowest \d|static compl|"
                       r"share of the|mass \d|[xyz]  +\d|\S+\.yaml:\d+:\d+: ")
kDeadline = 120  # s: until a session that was started is listed
kRecording = re.compile(r"\b(\w+)/(\w+)-(\d{8}-\d{6}|\.\.\.)")


def code_lines(text):
    """The lines of all code blocks: (line number, text without its indentation, number of the block)."""
    block, fence, before = 0, None, ""
    for number, line in enumerate(text.splitlines(), 1):
        if fence is not None:
            if line.strip().startswith("```"):
                fence = None
            else:
                yield number, line, block
        elif line.strip().startswith("```"):
            fence, block = line, block + 1
        elif line.startswith("    "):
            if not before.startswith("    ") and before.strip() == "":
                block += 1
            yield number, line[4:], block
        before = line


class Command:
    def __init__(self, document, line, text, block):
        self.document, self.line, self.text, self.block, self.printed = document, line, text, block, []
        self.place = f"{document}:{line}: {text}"


def commands_of(root, document):
    found = []
    for number, line, block in code_lines((root / document).read_text()):
        start = re.match(r"(?:\w+)?\$ (.*)", line)
        if start:
            # what stands behind three spaces is an explanation
            found.append(Command(document, number, re.split(r" {3,}", start[1])[0], block))
        elif found and found[-1].block == block:
            found[-1].printed.append(line)
        elif re.match(r"slewring [a-z]+ [\w.-]", line):
            sys.exit(f"{document}:{number}: '{line}' is a command without '$ ' before it")
    return found


class Rules:
    def __init__(self):
        table = tomllib.loads((pathlib.Path(__file__).parent / "commands.toml").read_text())
        self.documents = table["documents"]
        self.setup = table.get("setup", {})
        self.kinds = {kind: [(rule["in"] if "in" in rule else None, re.compile(rule["command"]), rule)
                             for rule in table.get(kind, [])] for kind in ("skip", "background", "change")}
        self.used = set()

    def of(self, kind, command):
        for place, expression, rule in self.kinds[kind]:
            if (place is None or place == command.document) and expression.match(command.text):
                self.used.add(id(rule))
                return rule
        return None

    def unused(self):
        return [f"{kind}: {rule['command']}" for kind, rules in self.kinds.items() for _, _, rule in rules
                if id(rule) not in self.used]


def documents(root, rules):
    return sorted({str(path.relative_to(root)) for pattern in rules.documents for path in root.glob(pattern)})


def check_list(root, slewring, rules):
    helps, faults, count = {}, [], 0
    for document in documents(root, rules):
        for command in commands_of(root, document):
            count += 1
            skipped = rules.of("skip", command)
            for kind in ("background", "change"):
                rules.of(kind, command)
            if not skipped and re.search(r"(^|\s)(sudo|ssh)\s", command.text):
                faults.append(f"{command.place}: needs root, and has no reason in commands.toml")
            verb = re.match(r"slewring ([a-z]+)", command.text)
            if not verb:
                continue
            # each option is one of the verb
            words = [verb[1]]
            if words[0] in ("param", "control", "flex", "device", "bridge", "keys", "import", "node"):
                words = command.text.split()[1:3]
            key = tuple(words) if words[0] != "control" else (words[0],)
            if key not in helps:
                done = subprocess.run([slewring, *key, "--help"], capture_output=True, text=True)
                helps[key] = done.stdout
            for option in re.findall(r"\s(--?[a-z][\w-]*)", re.sub(r"'[^']*'|\"[^\"]*\"|&&.*|#.*", "", command.text)):
                if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", helps[key]):
                    faults.append(f"{command.place}: slewring {' '.join(key)} has no option {option}")
    faults += [f"commands.toml: {rule} matches no command" for rule in rules.unused()]
    if faults:
        sys.exit("\n".join(faults))
    if count < 100:
        sys.exit(f"only {count} commands were found")
    print(f"{count} commands")


class Reader:
    """Types a document's commands into shells, in a folder that looks like a clone."""

    def __init__(self, root, build, domain, document, rules):
        self.rules, self.background, self.faults, self.done = rules, [], [], 0
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="slewring-commands-"))
        for name in ("scenes", "examples", "idl", "docs", "libs/client"):
            shutil.copytree(root / name, self.folder / name)
        (self.folder / "build").mkdir()
        (self.folder / "build/release").symlink_to(build)
        self.environment = dict(os.environ, SLEWRING_DOMAIN=domain, HOME=str(self.folder), COLUMNS="200",
                                PATH=f"{build}/bin:{os.environ['PATH']}")
        for line in rules.setup.get(document, []):
            subprocess.run(["bash", "-euc", line], cwd=self.folder, env=self.environment, check=True)
        self.scenes = re.findall(r"```yaml\n(.*?)```", (root / document).read_text(), re.S)

    def shell(self, text):
        return subprocess.Popen(["bash", "-c", text], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def end_background(self):
        for command, process, output in reversed(self.background):
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                self.faults.append(f"{command.place}: did not end")
            if process.returncode not in (0, 130, -signal.SIGINT):
                self.faults.append(f"{command.place}: ended with {process.returncode}\n{output.read_text()}")
        self.background = []

    def start(self, command, text):
        output = self.folder / f"output{command.line}"
        with open(output, "w") as file:
            process = subprocess.Popen(["bash", "-c", f"exec {text}"], cwd=self.folder, env=self.environment,
                                       stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT,
                                       start_new_session=True)
        self.background.append((command, process, output))
        end = time.monotonic() + kDeadline
        while re.match(r"slewring (run|window) ", text):
            listed = subprocess.run(["slewring", "sessions"], env=self.environment, capture_output=True, text=True)
            if "io running" in listed.stdout:
                return
            if process.poll() is not None or time.monotonic() > end:
                self.faults.append(f"{command.place}: no session runs\n{output.read_text()}")
                return

    def recording(self, match):
        folder, name = match[1], match[2]
        found = sorted(self.folder.glob(f"{folder}/{name}-*"), key=lambda path: path.stat().st_mtime)
        if not found:
            scene = f"scenes/{name}.yaml"
            done = self.shell(f"slewring run {scene} --in-process --pace free --duration 2s --out {folder}")
            output = done.communicate()[0]
            found = list(self.folder.glob(f"{folder}/{name}-*"))
            if not found:
                sys.exit(f"{scene} has made no recording\n{output}")
        return f"{folder}/{found[-1].name}"

    def read(self, command):
        if self.rules.of("skip", command):
            return
        self.done += 1
        print(command.place, flush=True)
        change = self.rules.of("change", command)
        if change and "file" in change:
            (self.folder / change["file"]).write_text(next(s for s in self.scenes if change["holds"] in s))
        if change and "before" in change:
            subprocess.run(["bash", "-euc", change["before"]], cwd=self.folder, env=self.environment, check=True)
        text = command.text
        if kRecording.search(text):
            self.end_background()  # a recording is read when it is closed
            text = kRecording.sub(self.recording, text)
        if change and ("add" in change or "replace" in change):
            text = re.sub(change["replace"], change["by"], text) if "replace" in change else f"{text} {change['add']}"
        if re.match(r"slewring run (?!.*--(?:from|in-process))", text):
            # other tests may keep the machine busy: a node that stands still stays in the session
            text = re.sub(r"( ?&)?$", r" --set session.give_up_after=60\1", text, count=1)
        starts_session = re.match(r"slewring (run|window|replay .*--then-live)\b", text) and "--in-process" not in text
        if starts_session and "--session" not in text:
            self.end_background()
        if self.rules.of("background", command) or text.endswith("&"):
            self.start(command, text.removesuffix("&").strip())
            return
        process = self.shell(text)
        output = process.communicate()[0]
        refusal = (change or {}).get("code", 2 if any(line.startswith("slewring: refused") or
                                                      re.match(r"\S+\.yaml:\d+:\d+: |--set \S+: ", line)
                                                      for line in command.printed) else 0)
        if process.returncode != refusal:
            self.faults.append(f"{command.place}: ended with {process.returncode}, expected {refusal}; ran {text}\n{output}")
        else:
            have = re.sub(r" +", " ", output)
            for line in command.printed:
                part = re.sub(r" +", " ", line).strip().removesuffix("...").strip()
                if kCompared.match(line.strip()) and part not in have:
                    like = [l for l in output.splitlines() if l.split()[:2] == line.split()[:2]] or ["nothing like it"]
                    self.faults.append(f"{command.place}: the document has\n  {line}\nand the command prints\n  {like[0]}")


def main():
    root, build, task = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    rules = Rules()
    if task == "list":
        return check_list(root, f"{build}/bin/slewring", rules)
    document = sys.argv[4]
    os.environ["PATH"] = f"{build}/bin:{os.environ['PATH']}"
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that sessions end with the test
    reader = Reader(root, build, take_domain(), document, rules)
    try:
        for command in commands_of(root, document):
            reader.read(command)
    finally:
        reader.end_background()
        shutil.rmtree(reader.folder, ignore_errors=True)
    if reader.faults:
        sys.exit("\n".join(reader.faults))
    print(f"{reader.done} commands of {document} were run" if reader.done else
          f"SKIPPED: every command of {document} has a reason in commands.toml")


main()
