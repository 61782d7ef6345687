# SPDX-License-Identifier: GPL-3.0-or-later
# A program built with MESHLODE_VULKAN off: --gpu says so, everything else works. Such builds alone try this case.
"$MESHLODE" build --quiet "$DATA/rock.glb" -o a.lode
run render a.lode -o a.png --gpu --view paths
run verify a.lode --source "$DATA/rock.glb" --gpu --cuts 1 --cameras 1 --deviation-cuts 1 | sed "s|$DATA|DATA|"
code render a.lode -o a.png --size 64x64
code verify a.lode --source "$DATA/rock.glb" --cuts 1 --cameras 1 --deviation-cuts 1 | sed "s|$DATA|DATA|"
files
