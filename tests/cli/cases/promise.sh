# SPDX-License-Identifier: GPL-3.0-or-later
# What is promised besides positions: built when asked for, chosen when drawn, refused with the remedy where it is not there.
cp "$DATA/foliage.glb" in.glb
code build --quiet in.glb -o plain.lode
code build --quiet in.glb -o position.lode --promise position
cmp plain.lode position.lode && echo "the usual bytes"
code build --quiet in.glb -o texels.lode --promise texels
code build --quiet in.glb -o appearance.lode --promise appearance --jobs 1
code build --quiet in.glb -o again.lode --promise appearance
cmp appearance.lode again.lode && echo "the same with one thread"
code validate --quiet texels.lode appearance.lode
json info info texels.lode --format json
json info info appearance.lode --format json
run render plain.lode -o no.png --promise texels
run extract texels.lode --error 0.1 -o no.glb --promise appearance
code render --quiet appearance.lode -o cut.png --size 64x48 --promise texels
code extract --quiet appearance.lode -o cut.glb --error 0.1 --promise appearance
# Stored otherwise, nothing of it is lost.
code repack --quiet appearance.lode -o small.lode --codec strips
code validate --quiet small.lode
code build --quiet in.glb -o strips.lode --promise appearance --codec strips
cmp small.lode strips.lode && echo "as built with that codec"
code render --quiet small.lode -o same.png --size 64x48 --promise texels
cmp cut.png same.png && echo "the same picture"
# Where positions are proven, so is what is promised.
code build --quiet in.glb -o proven.lode --promise appearance --error-tier certified
code validate --quiet proven.lode
code verify --quiet proven.lode --source in.glb
rm proven.lode
# Where positions are estimated, what is promised is measured all the same.
code build --quiet in.glb -o fast.lode --promise appearance --preset fast
code validate --quiet fast.lode
code verify --quiet fast.lode --source in.glb
rm fast.lode
run build in.glb -o no.lode --promise smooth
files
