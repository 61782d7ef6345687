# SPDX-License-Identifier: GPL-3.0-or-later
# verify --stream: cuts of random resident pages, without a source and beside one; threads change nothing.
"$MESHLODE" build --quiet "$DATA/rock.glb" -o rock.lode --page-size 16
cp "$DATA/city.glb" .
"$MESHLODE" build --quiet city.glb -o city.lode --preset fast
# How many cuts another rule would open, and by how much of its error a cut is off, are the build's.
words() { sed -E 's/alone [0-9]+ would/alone N would/; s/at most 0\.[0-9]+ of/at most N of/; s/^(.. +(ok|skipped)) +[0-9]+/\1/; s/^(- +(ok|skipped)) +[0-9]+/\1/'; }
run verify rock.lode --stream --residencies 500 | words
run verify rock.lode --stream --quiet --residencies 60
verify() { "$MESHLODE" verify rock.lode --stream --residencies 120 --seed 3 --format json --jobs "$1"; }
verify 1 >one.json; echo "exit $?"
verify 4 >four.json
cmp one.json four.json && echo "the same for 4 threads"
tr -d ' \n' <one.json | grep -oE '"residencies":[0-9]+|"naive_open":0|"verified":[a-z]+' | sort -u
json verify verify city.lode --stream --residencies 60 --format json
json verify verify city.lode --source city.glb --quick --stream --residencies 60 --format json
run verify city.lode --source city.glb --quick --stream --residencies 60 | grep -c "whichever pages"
run verify rock.lode city.lode --stream --residencies 60
# What cannot be.
run verify rock.lode --residencies 10
run verify rock.lode --stream --residencies 0
run verify rock.lode --stream --residencies 10000001
run verify rock.lode --stream --frames 10
run verify rock.lode --stream --gpu --frames 0
run verify rock.lode --stream --gpu --out-dir maps
run verify rock.lode
# Three bytes of a page: what is broken is named, and nothing behind it is looked at.
cp rock.lode broken.lode
printf '\377\000\377' | dd of=broken.lode bs=1 seek=$(($(wc -c <rock.lode) * 3 / 4)) conv=notrunc status=none
code verify broken.lode --stream
head -c 3000 rock.lode >short.lode
code verify short.lode --stream
files
