# SPDX-License-Identifier: GPL-3.0-or-later
# A page for the program and for each command, with all its options and the sections that one looks for, that readers of
# manual pages take without complaint; and the same options in docs/reference/cli/ as this program has them.
mkdir pages
code man -O pages
verbs=$("$MESHLODE" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z]*\) .*/\1/p')
for verb in $verbs; do
  page=pages/meshlode-$verb.1
  "$MESHLODE" man "$verb" | cmp - "$page"
  text=$(<"$page")
  for option in $("$MESHLODE" "$verb" --help | sed -nE 's/^( {2}|      )(-[^ ]*( --[^ ]*)?).*/\2/p' | tr , ' '); do
    [[ $text == *"\\fB${option//-/\\-}\\fR"* ]] || echo "$page lacks $option"
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
for page in pages/*.1; do
  text=$'\n'$(<"$page")$'\n'
  for section in NAME SYNOPSIS DESCRIPTION OPTIONS ENVIRONMENT "EXIT STATUS" "SEE ALSO"; do
    [[ $text == *$'\n'".SH $section"$'\n'* ]] || echo "$page lacks $section"
  done
done
grep -lx ".SH FILES" pages/*.1
# A terminal gets no roff.
if command -v script >/dev/null; then
  for path in "$PATH" /nowhere; do
    MANPAGER=cat TERM=dumb script -qec "PATH=$path '$MESHLODE' man cache" /dev/null </dev/null >shown
    grep -c '^\.SH' shown; grep -qE 'use or check the cache|--verify' shown && echo shown
  done
fi
mkdir reference
code man --format markdown -O reference
"$MESHLODE" man --format markdown build | cmp - reference/build.md
# UPDATE=1 writes docs/reference/cli/ anew.
[ "${UPDATE:-0}" = 1 ] && mkdir -p "$REPOSITORY/docs/reference/cli" && cp reference/*.md "$REPOSITORY/docs/reference/cli"
diff -r reference "$REPOSITORY/docs/reference/cli" && echo "docs/reference/cli is of this program"
code man nothing
code man build -O pages
code man -O missing
