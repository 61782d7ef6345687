#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What mkdocs and Doxygen do not check.

  tools/check_docs.py          links to headings exist; the number of words is within bounds
  tools/check_docs.py SITE     also: no page of the built site loads anything from elsewhere

Python's standard library alone.
"""
import html.parser
import os
import pathlib
import re
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
# A stranger reads all tutorials, guides and explanations in two hours (200 words a minute), and a page in a quarter of one.
# Pages with proofs are exempt from the second: they are normative.
MOST_WORDS, MOST_PAGE_WORDS = 25000, 2500
PROOFS = {"docs/explanation/numerics.md", "docs/explanation/border-proof.md"}
# Attributes by which a page loads something; a link that a reader may follow (`a href`) is not one.
LOADS = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "src"), ("object", "data")}


def headings(text):
    """The anchors of a page, as GitHub and mkdocs make them."""
    found = set()
    for line in re.findall(r"^#+ +(.*)$", without_code(text), re.M):
        line = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", line)
        found.add(re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", line).strip().lower()).replace(" ", "-"))
    return found


def without_code(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)


def check_links(pages):
    anchors = {name: headings(text) for name, text in pages.items()}
    for name, text in pages.items():
        for path, anchor in re.findall(r"\]\(([^)\s#:]*)#([^)\s]+)\)", without_code(text)):
            target = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
            if target in anchors and anchor not in anchors[target]:
                yield f"{name}: no heading for #{anchor} in {target}"


def check_words(pages):
    counted = {name: len(text.split()) for name, text in pages.items()
               if name == "docs/README.md" or re.match("docs/(tutorials|guides|explanation)/", name)}
    total = sum(counted.values())
    if total > MOST_WORDS:
        yield f"tutorials, guides and explanations have {total} words, {MOST_WORDS} are allowed"
    for name, count in counted.items():
        if count > MOST_PAGE_WORDS and name not in PROOFS:
            yield f"{name}: {count} words, {MOST_PAGE_WORDS} are allowed"


class Loads(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.addresses = []

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if tag == "link" and given.get("rel") == "canonical":
            return
        self.addresses += [value or "" for name, value in attributes if (tag, name) in LOADS]


def check_site(site):
    outside = re.compile(r"^(https?:)?//")
    for path in sorted(site.rglob("*.html")):
        page = Loads()
        page.feed(path.read_text(encoding="utf-8"))
        for address in page.addresses:
            if outside.match(address):
                yield f"{path}: loads {address}"
    for path in sorted(site.rglob("*.css")):
        for address in re.findall(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\"')\s]+)", path.read_text(encoding="utf-8")):
            yield f"{path}: loads {address}"


def main(arguments):
    names = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
    names += sorted(str(path.relative_to(REPOSITORY)) for path in (REPOSITORY / "docs").rglob("*.md"))
    pages = {name: (REPOSITORY / name).read_text(encoding="utf-8") for name in names}
    errors = list(check_links(pages)) + list(check_words(pages))
    for site in arguments:
        errors += check_site(pathlib.Path(site))
    for error in errors:
        print(error, file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
