# SPDX-License-Identifier: GPL-3.0-or-later
# The help of every command: at most 100 columns, examples before options, each option with a value says its default or
# that it is required, the manual last.
verbs=$("$MESHLODE" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z]*\) .*/\1/p')
echo "$verbs" | wc -l
check() {  # NAME: its help on stdin
  awk -v name="$1" '
    function end_option() {
      if (has_value && text !~ /\(default: |\(required\)/) print name ": no default: " text
      has_value = 0; text = ""
    }
    length($0) > 100 { print name ": " length($0) " columns: " $0 }
    /^Examples:/ { has_examples = 1 }
    /^[A-Z].*:$/ && !/^Examples:/ && !has_examples { print name ": examples are not first: " $0 }
    /^(  -|      --)/ {
      end_option()
      has_value = $0 ~ /--[a-z-]+ [^ ]/ && $0 !~ /--[a-z-]+  /
      options += 1
      with_value += has_value
    }
    /^$/ { end_option() }
    { text = text " " $0; last = $0 }
    END {
      if (last !~ /^Manual: /) print name ": the manual is not last: " last
      print name ": " (options > 1 ? "options" : "no options") ", " (with_value > 0 ? "some" : "none") " with a value"
    }'
}
for verb in $verbs study; do
  "$MESHLODE" "$verb" --help >help.txt
  check "$verb" <help.txt
  "$MESHLODE" help "$verb" | cmp - help.txt
  "$MESHLODE" "$verb" -h | cmp - help.txt
done
"$MESHLODE" --help >help.txt
awk 'length($0) > 80 { print "columns: " $0 }' help.txt
for word in help -h; do "$MESHLODE" "$word" | cmp - help.txt; done
"$MESHLODE" build --help
"$MESHLODE" --help
# Short forms mean what the long ones do.
"$MESHLODE" -V | cmp - <("$MESHLODE" --version) && echo "-V"
cp "$DATA/crystal.glb" a.glb
"$MESHLODE" build a.glb -o a.lode -q -j 1 -v >short.txt 2>&1; echo "exit $?"
"$MESHLODE" build a.glb -o b.lode --quiet --jobs 1 --explain >long.txt 2>&1
cmp short.txt long.txt && [ -s long.txt ] && cmp a.lode b.lode && echo "-q -j -v"
"$MESHLODE" render a.lode -o a.png -v >short.txt 2>&1; "$MESHLODE" render a.lode -o a.png --explain >long.txt 2>&1
cmp short.txt long.txt && grep -c '^plan of the asset' long.txt
# Plain English: none of these phrases in any help or page.
for verb in $verbs study; do "$MESHLODE" help "$verb"; done >all.txt
for verb in meshlode $verbs; do "$MESHLODE" man "$verb"; done >>all.txt
tr '\n' ' ' <all.txt | tr -s ' ' | grep -oE '(comma by comma|is told|are told|told of|not given|\bOf (a|an|the)\b|[a-z]+ a (triangle|coordinate|line|file) at most|(bytes|bits|triangles|row|line|case) a (triangle|mesh|file|scene|vertex|line)|\banew\b|\bmend[a-z]*\b|\bnobody\b|\bis no\b|\bare no\b|passed over)'
grep -c . all.txt | awk '{ print ($1 > 500 ? "read" : "nothing read") }'
