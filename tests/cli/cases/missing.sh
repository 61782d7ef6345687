# SPDX-License-Identifier: GPL-3.0-or-later
# A binary STL that is cut short in its second facet: what the file holds and the asset has not is never silent.
vector() { printf "\\0\\0\\$1\\$2\\0\\0\\$3\\$4\\0\\0\\0\\0"; }  # X Y, as the high bytes of floats
{
  printf '%80s\2\0\0\0'
  vector 0 0 0 0 && vector 0 0 0 0 && vector 200 77 0 0 && vector 0 0 200 77 && printf '\0\0'
  vector 0 0 0 0 && vector 0 0 0 0 && vector 200 77 0 0
} >cut.stl
"$MESHLODE" build cut.stl -o cut.lode 2>&1 | grep -v ' triangles\? in '
run doctor cut.stl --fail-on triangles-missing
"$MESHLODE" verify cut.lode --source cut.stl --quick | grep -E "FAILED|V115|NOT"
rm cut.lode
run build cut.stl -o cut.lode --strict
run build cut.stl -o cut.lode --strict --repair
files
