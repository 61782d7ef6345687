# SPDX-License-Identifier: GPL-3.0-or-later
# The program, which build it is, and what it stands on. Numbers are the machine's.
"$MESHLODE" --version >version.txt
sed -n '1p' version.txt | sed -E 's/[0-9]+\.[0-9]+\.[0-9]+/N.N.N/'
sed -n '2,4p' version.txt | sed -E 's/[0-9a-f]{32}$/ID/; s/(GCC|clang) [0-9.]+.*/COMPILER/'
# Every library, with a version that begins with a number.
sed -n '/^library/,$p' version.txt | sed -E 's/ +[0-9]+\.[0-9][0-9.]*( \(turbo\))? +/ N.N /'
# The build id is what a manifest names.
cp "$DATA/crystal.glb" a.glb
code build --quiet a.glb -o a.lode --manifest manifest.json
id=$(sed -n 's/^build id *//p' version.txt)
grep -c "\"$id\"" manifest.json
