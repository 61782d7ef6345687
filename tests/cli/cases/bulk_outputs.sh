# SPDX-License-Identifier: GPL-3.0-or-later
# render, extract and repack over many files: each output in the place of its input below -O, none over another or over
# what is read, the same for any number of threads, and what one file alone gives.
mkdir -p in/deep
cp "$DATA/rock.glb" in/a.glb
cp "$DATA/crystal.glb" in/deep/b.glb
cp "$DATA/crystal.glb" in/deep/a.glb
head -c 2000 "$DATA/rock.glb" >in/broken.glb
code build -q in -O out --preset fast --error-tier qem --manifest out/manifest.json
words() { case $1 in render) echo "--size 64x48";; extract) echo "--triangles 500";; repack) echo "--codec none";; esac; }
ext() { case $1 in render) echo png;; extract) echo glb;; repack) echo lode;; esac; }
for verb in render extract repack; do
  run $verb out -O $verb-1 $(words $verb) --jobs 1
  "$MESHLODE" $verb out -O $verb-7 $(words $verb) --jobs 7 --quiet
  "$MESHLODE" $verb 'out/**/*.lode' -O $verb-pattern $(words $verb) --quiet
  "$MESHLODE" $verb --manifest out/manifest.json -O $verb-manifest $(words $verb) --quiet
  echo "exit $?"
  for other in 7 pattern manifest; do diff -r $verb-1 $verb-$other; done
  for name in a deep/a deep/b; do
    "$MESHLODE" $verb out/$name.lode -o one.$(ext $verb) $(words $verb) --quiet && cmp one.$(ext $verb) $verb-1/$name.$(ext $verb)
  done
  json bulk $verb out -O $verb-json $(words $verb) --format json
  "$MESHLODE" $verb out/a.lode -O $verb-one $(words $verb) --format json | "$JSON_CHECK" "$SCHEMAS/$verb.schema.json"
  (cd $verb-1 && find . -type f | LC_ALL=C sort)
  # Two files of one name, given by themselves.
  run $verb out/a.lode out/deep/a.lode -O twice $(words $verb)
  run $verb out -o one.$(ext $verb) $(words $verb)
  run $verb out/a.lode -o one.$(ext $verb) -O twice $(words $verb)
  run $verb out/a.lode $(words $verb)
  run $verb $(words $verb) -O twice
done
ls twice 2>&1
# Nothing is written over what is read.
cp -r out kept
run repack out -O out --codec none
run repack out/deep 'out/*.lode' -O out/deep --codec none
diff -r out kept && echo unchanged
ln -s out/deep/b.lode link.png; mkdir pictures; ln -s ../out/a.lode pictures/a.png
run render out -O pictures --size 64x48
diff -r out kept && echo unchanged
run extract out/a.lode --level 0 -o - --junit x.xml
# A file that is broken stops nobody.
head -c 3000 out/a.lode >out/cut.lode
run repack out -O broken --codec none --junit broken.xml
grep -c '<failure\|<error' broken.xml
(cd broken && find . -type f | LC_ALL=C sort)
# A stuck view, and a warning for each of which it is said.
"$MESHLODE" extract out/deep -O stuck --stuck | sed 's/ *[0-9,]*  out/  out/'
rm -r pictures link.png
