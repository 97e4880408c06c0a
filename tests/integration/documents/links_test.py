#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every link of the documents resolves:

  links_test.py SOURCE_TREE          files and anchors of all Markdown files; docs/README.md leads to every document
  links_test.py SOURCE_TREE site     the same of the pages that launch_scripts/site makes, which load nothing from a network

Prints "SKIPPED: reason" where mkdocs is missing.
"""
import html.parser, os, pathlib, re, subprocess, sys, tempfile, urllib.parse

kLeftOut = {"build", "runs", "node_modules", ".git"}


def files(root, ending):
    for folder, inside, names in os.walk(root):
        inside[:] = sorted(name for name in inside if name not in kLeftOut and not name.startswith("."))
        yield from (pathlib.Path(folder, name) for name in sorted(names) if name.endswith(ending))


def without_code(text):
    text = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    return re.sub(r"(?<![^\n])\n(?: {4,}[^\n]*\n|\n)+", "\n\n", text)


def anchors_of(text, known={}):
    """GitHub's names of the headings, with -1, -2 behind repeated ones."""
    found = set()
    for heading in re.findall(r"^#{1,6} (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M), re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r" ", "-", re.sub(r"[^\w\- ]", "", heading.strip().lower()))
        free, n = name, 0
        while free in found:
            n += 1
            free = f"{name}-{n}"
        found.add(free)
    return found | set(re.findall(r'<a (?:id|name)="([^"]+)"', text))


def check_sources(root):
    faults, linked, count = [], {}, 0
    texts = {path: path.read_text() for path in files(root, ".md")}
    for path, text in texts.items():
        for link in re.findall(r"\]\(([^()\s]+)\)", without_code(text)):
            if re.match(r"[a-z]+:", link):
                continue
            count += 1
            place, _, part = link.partition("#")
            target = pathlib.Path(os.path.normpath(path.parent / place)) if place else path
            linked.setdefault(target, set()).add(path)
            if not target.exists():
                faults.append(f"{path.relative_to(root)}: {link}: no such file")
            elif part and target.suffix == ".md" and part not in anchors_of(texts[target]):
                faults.append(f"{path.relative_to(root)}: {link}: no such heading")
    reached, waiting = set(), [root / "docs/README.md"]
    while waiting:
        page = waiting.pop()
        if page not in reached:
            reached.add(page)
            waiting += [target for target, by in linked.items() if page in by and target.suffix == ".md"]
            waiting += [entry for target, by in linked.items() if page in by and target.is_dir() for entry in target.glob("*.md")]
    faults += [f"{path.relative_to(root)}: no document leads here from docs/README.md" for path in texts
               if path.is_relative_to(root / "docs") and path not in reached]
    if count < 500:
        faults.append(f"only {count} links were found")
    return faults, f"{count} links"


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors |= {attributes[key] for key in ("id", "name") if attributes.get(key)}
        if tag == "a" and attributes.get("href"):
            self.links.append(attributes["href"])
        if tag in ("script", "img", "iframe") and attributes.get("src"):
            self.loaded.append(attributes["src"])
        if tag == "link" and attributes.get("href") and attributes.get("rel") != "canonical":
            self.loaded.append(attributes["href"])


def check_site(root, folder):
    done = subprocess.run([root / "launch_scripts/site", folder], capture_output=True, text=True)
    if "mkdocs is not here" in done.stderr:
        print("SKIPPED: mkdocs is not here")
        sys.exit(0)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)
    site = pathlib.Path(folder).resolve()
    texts = {path: Page(path.read_text()) for path in files(site, ".html")}
    faults, count = [], 0
    for path, page in texts.items():
        here = path.relative_to(site)
        if here.name == "404.html":
            continue
        for link in page.links + page.loaded:
            link = urllib.parse.unquote(link)
            if re.match(r"(https?:)?//", link):
                if link in page.loaded:
                    faults.append(f"{here}: loads {link} from the network")
                continue
            if re.match(r"[a-z]+:", link):
                continue
            count += 1
            place, _, part = link.partition("#")
            target = pathlib.Path(os.path.normpath(path.parent / place.partition("?")[0])) if place else path
            if target.is_dir():
                target = target / "index.html"
            if not target.exists():
                faults.append(f"{here}: {link}: no such page")
            elif part and target in texts and part not in texts[target].anchors:
                faults.append(f"{here}: {link}: no such anchor")
    for sheet in files(site, ".css"):
        faults += [f"{sheet.relative_to(site)}: loads {url} from the network"
                   for url in re.findall(r"url\(['\"]?(https?://[^)'\"]+)", sheet.read_text())]
    if not (site / "search/search_index.json").exists():
        faults.append("the site has no search")
    if len(texts) < 100:
        faults.append(f"only {len(texts)} pages were made")
    return faults, f"{count} links of {len(texts)} pages"


root = pathlib.Path(sys.argv[1]).resolve()
if sys.argv[2:] == ["site"]:
    with tempfile.TemporaryDirectory() as folder:
        faults, said = check_site(root, folder)
else:
    faults, said = check_sources(root)
if faults:
    sys.exit("\n".join(faults))
print(said)
