# SPDX-License-Identifier: GPL-3.0-or-later
# verify --quick: the same exit codes as verify, what it left out is named, and breakage is found.
"$MESHLODE" build --quiet "$DATA/crystal.glb" -o a.lode
run verify a.lode --source "$DATA/crystal.glb" --quick | grep -E "skipped|verified|meshlode|exit" | sed "s|$DATA|DATA|"
# Another source: its hash, and what a cut deviates by.
run verify a.lode --source "$DATA/rock.glb" --quick --quiet --force | grep -oE "^(V[0-9]+|exit.*)" | LC_ALL=C sort -u
# Three bytes of a page.
cp a.lode broken.lode
printf '\377\000\377' | dd of=broken.lode bs=1 seek=$(($(wc -c <a.lode) * 3 / 4)) conv=notrunc status=none
code verify broken.lode --source "$DATA/crystal.glb" --quick | sed "s|$DATA|DATA|"
code verify broken.lode --source missing.glb --quick
files
