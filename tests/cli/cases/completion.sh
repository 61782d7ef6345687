# SPDX-License-Identifier: GPL-3.0-or-later
# Every option that a verb's help names is completed, in every shell's script; bash is asked in earnest.
for shell in bash zsh fish; do "$MESHLODE" completion $shell >$shell.txt; done
code completion bash -o written.txt
cmp bash.txt written.txt
bash -n bash.txt
# complete WORD…: what bash offers for the last word
complete_words() {
  # shellcheck disable=SC1091
  bash -c 'source bash.txt; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _meshlode; echo "${COMPREPLY[*]}"' _ "$@"
}
verbs=$("$MESHLODE" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z]*\) .*/\1/p')
[ "$(complete_words meshlode '')" = "$(echo $verbs --help --version)" ] && echo "verbs"
options=0
for verb in $verbs; do
  offered=" $(complete_words meshlode "$verb" -) "
  in_zsh=$(sed -n "/^    $verb)\$/,/^      ;;\$/p" zsh.txt)
  in_fish=$(grep -F -e "'__meshlode_verb_is $verb'" fish.txt)
  # At the beginning of a line of the help, "-o, --output FILE" or "    --report FILE".
  for option in $("$MESHLODE" "$verb" --help | sed -nE 's/^( {2}|      )(-[^ ]*( --[^ ]*)?).*/\2/p' | tr , ' '); do
    options=$((options + 1))
    [[ $offered == *" $option "* ]] || echo "bash lacks $verb $option"
    [[ $in_zsh == *[\'\)]"$option"[]=+[]* ]] || echo "zsh lacks $verb $option"
    case $option in --*) fish="-l ${option#--}" ;; *) fish="-s ${option#-}" ;; esac
    [[ $in_fish == *" $fish "* ]] || echo "fish lacks $verb $option"
  done
done
[ "$options" -gt 100 ] && echo "options"
complete_words meshlode pl
complete_words meshlode build --codec s
complete_words meshlode build --codec = s
complete_words meshlode build --codec =
complete_words meshlode build -o s
complete_words meshlode info --qu
complete_words meshlode info a.lo
complete_words meshlode completion ''
complete_words meshlode nothing -
run completion
run completion tcsh
code completion bash -o missing/file
