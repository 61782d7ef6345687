# SPDX-License-Identifier: GPL-3.0-or-later
# Files appear whole or not at all, never over the input, and where the command says.
cp "$DATA/crystal.glb" a.glb
code build --quiet a.glb
code build --quiet a.glb -o named.lode
cmp a.lode named.lode && echo same bytes
code build --quiet a.glb -o no/such/folder/a.lode
code build --quiet a.glb -o a.glb
ln -s a.glb link.glb
code build --quiet a.glb -o link.glb
cmp "$DATA/crystal.glb" a.glb && echo input untouched
mkdir taken.lode
code build --quiet a.glb -o taken.lode
echo "printed when quiet: $("$MESHLODE" build --quiet a.glb -o b.lode 2>&1 | wc -c)"
"$MESHLODE" build a.glb -o c.lode >../stdout 2>../stderr
echo "on stdout: $(wc -c <../stdout)"
echo "bars when not a terminal: $(grep -c $'\r' ../stderr)"
files
