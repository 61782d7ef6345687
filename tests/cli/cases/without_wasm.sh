# SPDX-License-Identifier: GPL-3.0-or-later
# A program built without the WebAssembly runtime: --html says so before it looks at anything, all else works. Such builds
# alone try this case; page.sh is that of the others.
code build --quiet "$DATA/crystal.glb" -o a.lode | sed "s|$DATA|DATA|"
run info --quiet a.lode --html a.html
run info --quiet no/such/file.lode --html a.html
code info a.lode --format csv
files
