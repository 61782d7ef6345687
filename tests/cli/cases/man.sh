# SPDX-License-Identifier: GPL-3.0-or-later
# A page for the program and for each verb, with all its options, that readers of manual pages take without complaint.
mkdir pages
code man -O pages
verbs=$("$MESHLODE" --help | sed -n '/^verbs:/,/^$/s/^  \([a-z]*\) .*/\1/p')
for verb in $verbs; do
  page=pages/meshlode-$verb.1
  "$MESHLODE" man "$verb" | cmp - "$page"
  for option in $("$MESHLODE" "$verb" --help | sed -n 's/^  \(-[^ ]*\).*/\1/p' | tr , ' '); do
    grep -qF -e "\\fB${option//-/\\-}\\fR" "$page" || echo "$page lacks $option"
  done
  grep -qF -e "\\fB$verb\\fR" pages/meshlode.1 || echo "meshlode.1 lacks $verb"
done
"$MESHLODE" man | cmp - pages/meshlode.1
[ "$(ls pages | wc -l)" -eq $(($(echo "$verbs" | wc -l) + 1)) ] && echo "a page each"
if command -v mandoc >/dev/null; then
  # No date: pages of equal programs are equal.
  mandoc -T lint -W warning pages/*.1 | grep -v 'missing date'
fi
if command -v man >/dev/null; then
  for page in pages/*.1; do LC_ALL=C.UTF-8 MANWIDTH=100 man --warnings -l "$page" 2>&1 >/dev/null; done
fi
code man nothing
code man build -O pages
code man -O missing
