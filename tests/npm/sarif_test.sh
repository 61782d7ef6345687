#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sarif_test.sh MESHLODE: what `report --format sarif` writes of batches with failures, faults and names that try to be more
# than names is SARIF 2.1.0: ajv holds it against the OASIS schema, which @microsoft/jest-sarif carries
# (lib/schemas/sarif-2.1.0-rtm.5.json). Skipped, aloud, where npm or its registry is not there; with MESHLODE_REQUIRE_NPM=1
# that is a failure.
set -uo pipefail
program=$(realpath "$1")
data=$(cd "$(dirname "$0")/../.." && pwd)/data
unset MESHLODE_CACHE
skip() {
  [ "${MESHLODE_REQUIRE_NPM:-}" != 1 ] || { echo "FAILED: $*, and MESHLODE_REQUIRE_NPM=1"; exit 1; }
  echo "SKIPPED: $*"; exit 77
}
for tool in node npm; do
  command -v $tool >/dev/null || skip "no $tool (Debian: nodejs npm)"
done
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export npm_config_update_notifier=false NO_UPDATE_NOTIFIER=1
npm install --no-audit --no-fund --ignore-scripts --legacy-peer-deps @microsoft/jest-sarif@1.0.0-beta.0 ajv@8.17.1 ajv-draft-04@1.0.0 ajv-formats@3.0.1 >npm.log 2>&1 ||
  { tail -n 5 npm.log; skip "npm cannot install ajv and the schema"; }
cat >check.js <<'END'
// check.js FILE…: the number of results of each, or what the schema has against it.
const fs = require("fs");
const Ajv = require("ajv-draft-04").default;
const schema = JSON.parse(fs.readFileSync("node_modules/@microsoft/jest-sarif/lib/schemas/sarif-2.1.0-rtm.5.json"));
// Two patterns of the schema are no Unicode expressions.
const ajv = new Ajv({strict: false, allErrors: true, unicodeRegExp: false});
require("ajv-formats").default(ajv);
const validate = ajv.compile(schema);
let failed = 0;
for (const file of process.argv.slice(2)) {
  const document = JSON.parse(fs.readFileSync(file));
  const ok = validate(document);
  console.log(file + ": " + (ok ? document.runs[0].results.length + " results, valid" : JSON.stringify(validate.errors[0])));
  if (!ok) failed = 1;
}
process.exit(failed);
END
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
mkdir -p 'in/deep <b> %41' out
cp "$data/rock.glb" in/a.glb
cp "$data/foliage.glb" 'in/deep <b> %41/javascript:x #?.glb'
head -c 2000 "$data/rock.glb" >in/broken.glb
printf 'solid x\nendsolid x\n' >in/nothing.stl
printf 'no scene' >"in/<script>\"&'.glb"
printf 'no scene' >$'in/\xff\x80 not UTF-8\n.glb'
"$program" build in -O out --preset fast --error-tier qem --manifest now.json --quiet >/dev/null 2>&1
"$program" report now.json --format sarif -o now.sarif || fail "report of a batch with failures"
"$program" build in/a.glb -o out/a.lode --preset fast --error-tier qem --manifest good.json --quiet || fail "build"
"$program" report good.json --format sarif -o good.sarif || fail "report of a good batch"
rm -f out/a.lode
"$program" report good.json --format sarif -o gone.sarif || fail "report of an asset that is gone"
node check.js now.sarif good.sarif gone.sarif || fail "not SARIF 2.1.0"
grep -q '"level": "error"' now.sarif || fail "no failure is in it"
grep -q unreadable-asset gone.sarif || fail "the lost asset is not in it"
# The check can fail: a level that there is not, a result without a message, and another version.
sed 's/"level": "error"/"level": "fatal"/' now.sarif >level.sarif
sed 's/"message"/"massage"/' now.sarif >message.sarif
sed 's/"version": "2.1.0"/"version": "2.2.0"/' now.sarif >version.sarif
for spoilt in level message version; do
  said=$(node check.js $spoilt.sarif) && fail "$spoilt.sarif passes"
  [[ $said == "$spoilt.sarif: {\"instancePath\""* ]] || fail "$spoilt.sarif was not checked"
done
[ $failures -eq 0 ] && echo "PASSED"
[ $failures -eq 0 ]
