# SPDX-License-Identifier: GPL-3.0-or-later
# info --html: one file, the same for the same asset whatever the codec of its pages and the number of threads.
cp "$DATA/rock.glb" a.glb
code build --quiet a.glb -o a.lode
code build --quiet a.glb -o plain.lode --codec none
run info --quiet a.lode --html a.html
[ -s a.html ] && grep -c '<title>a.lode</title>' a.html
mkdir again && cp a.lode again/
OMP_NUM_THREADS=1 taskset -c 0 "$MESHLODE" info --quiet again/a.lode --html again/a.html && cmp a.html again/a.html && echo "the same"
# Beside what is printed, not instead of it.
"$MESHLODE" info a.lode --format csv --html b.html | head -1 | cut -c 1-9
cmp a.html b.html && echo "the same"
# What it tells of the file's bytes is what info tells, whatever codec is embedded.
code build --quiet a.glb -o packed.lode --codec strips
"$MESHLODE" info packed.lode --format json --html packed.html | tr -d ' \n' | grep -o '"name":"PAGE","bytes":[0-9]*' | cut -d : -f 3 >said
tr -d ' \n' <packed.html | grep -o '\["PAGE",[0-9]*\]' | tr -dc '0-9\n' | cmp - said && echo "the same bytes"
# What was read is not written over, what was written neither.
run info --quiet a.lode --html a.lode
run info --quiet a.lode --html no/such/folder/a.html
run info --quiet a.lode --html ''
# Of a smaller page the coarse levels.
run info --quiet a.lode --html small.html --html-limit 0
[ "$(stat -c %s small.html)" -lt "$(stat -c %s a.html)" ] && echo smaller
run info --quiet a.lode --html small.html --html-limit many
run info --quiet a.lode --html-limit 8MiB
# A name that would be markup.
cp a.lode '<b>&"x.lode'
run info --quiet '<b>&"x.lode' --html x.html
grep -o '<title>.*</title>' x.html
grep -c '<b>&"x' x.html
# A broken page: an error, and no file.
cp plain.lode broken.lode
printf 'broken' | dd of=broken.lode bs=1 seek=$(($(stat -c %s broken.lode) * 3 / 4)) conv=notrunc 2>../stderr
"$MESHLODE" info --quiet broken.lode --html broken.html 2>../stderr
echo "exit $?"
grep -c '' <../stderr
files
