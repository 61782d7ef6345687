# SPDX-License-Identifier: GPL-3.0-or-later
# What images take decoded is bounded: one line names the image, its size, and the option; the picture is drawn without it.
cp "$DATA/rock.glb" a.glb
code build --quiet a.glb -o a.lode
code render --quiet a.lode -o whole.png --size 64x64
run render --quiet a.lode -o without.png --size 64x64 --max-decoded 10KiB
cmp -s whole.png without.png || echo "the pictures differ"
run render a.lode -o x.png --max-decoded 512MX
run verify a.lode --source a.glb --max-decoded 1.5GiB
run extract a.lode --error 0 -o x.glb --max-decoded ''
code extract --quiet a.lode --error 0 -o cut.glb --max-decoded 0
files
