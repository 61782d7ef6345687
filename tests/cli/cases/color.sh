# SPDX-License-Identifier: GPL-3.0-or-later
# Colour: on a terminal alone, unless --color, NO_COLOR or TERM say otherwise; without its codes the text is the same.
cp "$DATA/rock.glb" .
code build -q rock.glb -o rock.lode
head -c 1000 rock.lode >broken.lode
escape=$(printf '\033')
plain() { sed "s/$escape\[[0-9;]*m//g"; }
# both WORDS…: the codes of the words with --color always, and that nothing else differs.
both() {
  "$MESHLODE" "$@" --color always >always.txt 2>&1
  "$MESHLODE" "$@" --color never >never.txt 2>&1
  "$MESHLODE" "$@" >auto.txt 2>&1
  cmp never.txt auto.txt
  plain <always.txt | cmp - never.txt
  echo "$1: $(grep -o "$escape\[[0-9;]*m[^$escape]*" always.txt | tr -d "$escape" | grep -v '^\[0m' | sort -u | head -4 | tr '\n' ' ')"
}
both verify rock.lode --source rock.glb --quick
both validate rock.lode
both validate broken.lode
both info broken.lode
both doctor rock.lode
both info rock.lode --format json
both plan nothing.glb
# on WORDS…: whether a terminal is shown colours
on() { script -qec "$*" /dev/null | grep -c "$escape\[3[12]m"; }
if command -v script >/dev/null; then
  export TERM=xterm
  on "'$MESHLODE' validate rock.lode"
  on "NO_COLOR=1 '$MESHLODE' validate rock.lode"
  on "NO_COLOR= '$MESHLODE' validate rock.lode"
  on "TERM=dumb '$MESHLODE' validate rock.lode"
  on "'$MESHLODE' validate rock.lode --color never"
  on "NO_COLOR=1 '$MESHLODE' validate rock.lode --color always"
fi
run validate rock.lode --color sometimes
# Tables fit in 80 columns; what is no table is a line each.
cp "$DATA"/city.glb .
code build -q city.glb -o city.lode
code build -q rock.glb -o best.lode --preset best --promise texels
code build -q rock.glb -o plain.lode --attributes none
for words in "info rock.lode" "info city.lode" "info best.lode --stuck" "info plain.lode" "compare rock.lode best.lode"; do
  "$MESHLODE" $words | grep -vE '^(settings|kept|left out) ' |
    awk -v words="$words" 'length($0) > 80 { print words ": " length($0) " columns: " $0 } END { print words, NR > 10 }'
done
