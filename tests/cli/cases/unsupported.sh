# SPDX-License-Identifier: GPL-3.0-or-later
# What later issues bring answers 5, before any file is touched.
run build nothing.glb --preset fast
run build nothing.glb --preset best
files
