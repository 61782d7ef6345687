#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# report_test.sh SAMPLE_REPORT MESHLODE: the report of a made-up sweep in headless Chromium, 1280 and 400 pixels wide, by light
# and by dark, and that of a short real one: tables sort, points are picked out, pictures lie over each other, nothing is wider
# than the window, and no message is in the console. Screenshots stay in MESHLODE_SCREENSHOTS where that is set. Skipped, aloud,
# without chromium or python3; with MESHLODE_REQUIRE_BROWSER=1 that is a failure.
set -uo pipefail
sample=$(realpath "$1"); meshlode=$(realpath "$2")
here=$(cd "$(dirname "$0")" && pwd)
scene=$here/../../data/crystal.glb
skip() {
  [ "${MESHLODE_REQUIRE_BROWSER:-}" != 1 ] || { echo "FAILED: $*, and MESHLODE_REQUIRE_BROWSER=1"; exit 1; }
  echo "SKIPPED: $*"; exit 77
}
for tool in chromium python3; do
  command -v $tool >/dev/null || skip "no $tool (Debian: $tool)"
done
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
shots=${MESHLODE_SCREENSHOTS:-$work/shots}
mkdir -p "$shots"
cd "$work" || exit 1
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

"$sample" report || { echo "FAILED: no report"; exit 1; }
"$meshlode" sweep "$scene" -o swept --quiet --rounds 1 --samples 200 --budget 60s || { echo "FAILED: no sweep"; exit 1; }
# Another reader's word that page and plots are well-formed.
python3 - {report,swept}/index.html {report,swept}/plots/*.svg <<'END' || fail "not well-formed"
import sys, xml.etree.ElementTree as tree
for name in sys.argv[1:]:
    tree.parse(name)
END

# The probe goes behind the page's own script; a frame stands for a window narrower than Chromium makes one.
python3 - "$here/report_probe.js" <<'END'
import sys
probe = open(sys.argv[1], encoding="utf-8").read()
for folder in "report", "swept":
    page = open(folder + "/index.html", encoding="utf-8").read()
    assert page.count("</body>") == 1
    open(folder + "/probe.html", "w", encoding="utf-8").write(
        page.replace("</body>", "<script>" + probe.replace("</script", "") + "</script></body>"))
END

# browse OUTPUT ARGUMENT...: Chromium's standard output, its console messages in OUTPUT.console
browse() {
  local output=$1; shift
  timeout 120 chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --no-first-run --disable-extensions \
    --user-data-dir="$work/profile" --virtual-time-budget=4000 --enable-logging=stderr "$@" >"$output" 2>"$output.log" ||
    { tail -n 5 "$output.log"; fail "chromium $*"; }
  grep -a 'CONSOLE' "$output.log" >"$output.console" && { cat "$output.console"; fail "messages in the console: $*"; }
  return 0
}
# probe NAME FOLDER ARGUMENT...: what the probe found
probe() {
  local name=$1 folder=$2; shift 2
  browse "$name.dom" "$@" --dump-dom "file://$work/$folder/probe.html"
  sed -n '/<pre id="probe">/,/^end/p' "$name.dom" | sed 's/.*<pre id="probe">//; s/<\/pre>.*//' >"$name.said"
  grep -q '^end' "$name.said" || fail "$name: the probe did not finish"
  [ "$(grep -c '^ok ' "$name.said")" -ge 18 ] || fail "$name: too few checks"
  ! grep '^FAILED' "$name.said" || fail "$name"
  echo "  $name: $(grep -c '^ok ' "$name.said") checks hold"
}
dark=--blink-settings=preferredColorScheme=0 light=--blink-settings=preferredColorScheme=1
probe wide-light report $light --window-size=1280,1000
probe wide-dark report $dark --window-size=1280,1000
probe middle report $light --window-size=700,1000
probe swept swept $light --window-size=1280,1000

# shoot NAME WIDTH HEIGHT SCHEME: the page as it is first seen, in a frame of that width
shoot() {
  printf '<!DOCTYPE html><style>body{margin:0}iframe{border:0;width:%spx;height:%spx}</style><iframe src="index.html"></iframe>' \
    "$2" "$3" >report/frame.html
  browse "$1.out" "$4" --window-size="$2,$3" --screenshot="$shots/$1.png" "file://$work/report/frame.html"
  [ "$(stat -c %s "$shots/$1.png" 2>/dev/null || echo 0)" -gt 20000 ] || fail "$1: no picture to speak of"
}
shoot report-1280-light 1280 7000 $light
shoot report-1280-dark 1280 7000 $dark
shoot report-400-light 400 14000 $light
shoot report-400-dark 400 14000 $dark
[ $failures -eq 0 ] && echo "PASSED"
[ $failures -eq 0 ]
