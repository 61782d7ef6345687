#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""release_check_test.py REPOSITORY: tools/release-check in a repository of its own, with one table in one page."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(sys.argv[1])
ENVIRONMENT = {**os.environ, "GIT_CONFIG_GLOBAL": os.devnull, "GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@example.org",
               "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@example.org"}
PAGE = "text\n<!-- accuracy: begin -->\n\n| a |\n\n<!-- accuracy: end -->\nmore\n"


def git(root, *arguments):
    return subprocess.run(["git", "-C", root, *arguments], check=True, capture_output=True, text=True, env=ENVIRONMENT).stdout.strip()


def commit(root, path, text):
    (root / path).parent.mkdir(parents=True, exist_ok=True)
    (root / path).write_text(text)
    git(root, "add", path)
    git(root, "commit", "-q", "-m", path)
    return git(root, "rev-parse", "HEAD")


def check(root, what, wanted, *arguments):
    """Passes with `wanted` empty, else fails and says it."""
    done = subprocess.run([sys.executable, "-B", SOURCE / "tools/release-check", "--root", root, *arguments],
                          capture_output=True, text=True, env=ENVIRONMENT)
    said = done.stdout + done.stderr
    is_right = wanted in said and (done.returncode == (1 if wanted and not arguments else 0))
    print(("ok: " if is_right else f"FAILED, exit {done.returncode}, {said!r}: ") + what)
    return is_right


def main():
    if shutil.which("git") is None:
        print("SKIPPED: no git")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        git(root, "init", "-q")
        script = (SOURCE / "bench/results.py").read_text()
        table = script[:script.index('if __name__')] + 'TABLES = {"accuracy": TABLES["accuracy"]}\n'
        commit(root, "bench/results.py", table)
        code = commit(root, "src/builder/a.cpp", "1")
        commit(root, "README.md", PAGE)
        result = root / "docs/log/results/accuracy.json"
        result.parent.mkdir(parents=True)
        passed = [check(root, "no result", "accuracy.json is missing")]

        def write(**changed):
            sys.path.insert(0, str(root / "bench"))
            import results  # the copy
            sha = results.page_hash(root, "accuracy", results.TABLES["accuracy"])
            result.write_text(json.dumps({"commit": code, "is_changed": False, "page_sha256": sha, **changed}))

        write()
        passed += [check(root, "a fresh table", ""), check(root, "its age", "1 of 1", "--age")]
        write(is_changed=True)
        passed += [check(root, "measured with local changes", "no commit has")]
        write(commit="0" * 40)
        passed += [check(root, "a commit that nobody has", "is not in the repository")]
        result.write_text("[]")
        passed += [check(root, "not a result", "is not a result")]
        write()
        commit(root, "docs/other.md", "text")
        passed += [check(root, "another page changed", "")]
        (root / "README.md").write_text(PAGE.replace("| a |", "| b |"))
        passed += [check(root, "a figure changed by hand", "another text")]
        (root / "README.md").write_text("text")
        passed += [check(root, "no markers", "markers are missing")]
        (root / "README.md").write_text(PAGE)
        commit(root, "src/builder/a.cpp", "2")
        passed += [check(root, "the code changed", "1 commits changed the code"), check(root, "its age", "0 of 1", "--age")]
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main())
