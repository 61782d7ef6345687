#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# docs.sh: builds the site of README.md and docs/ into build/docs/site, with the public headers as HTML by Doxygen. Every warning
# of either is an error, and so is a page that would load something from elsewhere, a link to a heading that does not exist
# and more words than docs/ may have. Exit 77, with a message, if mkdocs, mkdocs-material or Doxygen is missing
# (tools/install-deps.sh --tests --docs).
#   To read it: python3 -m http.server --directory build/docs/site
set -euo pipefail
cd "$(dirname "$0")/.."

for program in mkdocs doxygen; do
  command -v "$program" >/dev/null || { echo "SKIPPED: tools/docs.sh: no $program"; exit 77; }
done
mkdocs build --help | grep -q material || { echo "SKIPPED: tools/docs.sh: no mkdocs-material"; exit 77; }

source=build/docs/source site=build/docs/site
rm -rf build/docs
mkdir -p "$source/tools/wasm" "$source/include/meshlode"
cp -r README.md CHANGELOG.md CONTRIBUTING.md SECURITY.md LICENSE LICENSES docs "$source"
cp tools/wasm/README.md "$source/tools/wasm/"
cp include/meshlode/decode.glsl "$source/include/meshlode/"
rm "$source/docs/mkdocs.yml" "$source/docs/Doxyfile"

python3 -B tools/schema_pages.py "$source/docs/schemas"
doxygen docs/Doxyfile
printf '\nEvery function and record: [headers](../../api/index.html).\n' >>"$source/docs/reference/api.md"
mkdocs build --quiet --strict --config-file docs/mkdocs.yml
python3 -B tools/check_docs.py "$site"
