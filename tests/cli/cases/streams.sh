# SPDX-License-Identifier: GPL-3.0-or-later
# `-` as an input and as an output gives the same as a file, and nothing else gets into the stream.
cp "$DATA/rock.glb" .
code build -q rock.glb -o rock.lode
# same WORDS…: what the command prints with the file, and with the file on stdin, but for its name.
same() {
  local file=$1; shift
  "$MESHLODE" "$@" "$file" >file.txt 2>&1; local status=$?
  "$MESHLODE" "$@" - <"$file" >stream.txt 2>&1; echo "$* -: exit $?, $status"
  cat "$file" | "$MESHLODE" "$@" - >pipe.txt 2>&1
  cmp stream.txt pipe.txt
  sed "s/$file/stdin/g" file.txt | diff - stream.txt
}
head -c 1000 rock.lode >broken.lode
: >empty.lode
for file in rock.lode broken.lode empty.lode rock.glb; do
  same $file info
  same $file info --format json
  same $file validate
  same $file validate --format json
  same $file doctor
  same $file doctor --format json
done
run validate - - <rock.lode
run info - <rock.glb
# Outputs.
for words in "info rock.lode" "info rock.lode --format csv" "plan rock.glb" "plan rock.glb --format json"; do
  "$MESHLODE" $words >printed.txt
  "$MESHLODE" $words -o - | cmp - printed.txt
  "$MESHLODE" $words -o written; echo "$words: exit $?"
  cmp written printed.txt
done
"$MESHLODE" extract rock.lode --triangles 500 -o cut.glb >said.txt
"$MESHLODE" extract rock.lode --triangles 500 -o - >stream.glb 2>beside.txt; echo "extract: exit $?"
cmp cut.glb stream.glb
sed 's/^cut.glb/-/' said.txt | diff - beside.txt
"$MESHLODE" extract rock.lode --stuck -o - 2>/dev/null | head -c 4; echo
run extract rock.lode --triangles 500 -o - --format json
for words in 'render rock.lode --size 32x32 -o rock.png' 'repack rock.lode --codec none -o plain.lode'; do
  file=${words##* }
  "$MESHLODE" $words >said.txt
  "$MESHLODE" ${words% *} - >stream.bin 2>beside.txt; echo "$words: exit $?"
  cmp $file stream.bin
  sed "s/$file/-/" said.txt | diff - beside.txt
  run ${words% *} - --format json
  rm $file stream.bin
done
run info rock.lode -o rock.lode
run plan rock.glb -o rock.glb
run plan rock.glb -o plan.png
code info rock.lode --format json -o written.txt
code info rock.lode -o /dev/full
rm -f ./*.txt written; files
