# SPDX-License-Identifier: GPL-3.0-or-later
# zsh and fish take their scripts, and fish offers what it should.
command -v zsh >/dev/null && command -v fish >/dev/null || skip "no zsh or no fish"
export HOME=$PWD
"$MESHLODE" completion zsh >_meshlode
"$MESHLODE" completion fish >meshlode.fish
zsh -n _meshlode && echo "zsh reads it"
zsh -fc 'autoload -Uz compinit; compinit -D -u; source ./_meshlode; echo ${_comps[meshlode]}'
fish -N -n meshlode.fish && echo "fish reads it"
offer() { fish -N -c 'source meshlode.fish; complete -C $argv[1]' "$1" | LC_ALL=C sort; }
offer "meshlode pl"
offer "meshlode build --codec s"
offer "meshlode info --qui"
offer "meshlode extract plan --meas"
offer "meshlode completion "
