# SPDX-License-Identifier: GPL-3.0-or-later
# verify: a scene whose meshes have several materials holds, in all pictures too.
cp "$DATA/city.glb" .
code build --quiet city.glb -o city.lode
code verify --quiet city.lode --source city.glb
