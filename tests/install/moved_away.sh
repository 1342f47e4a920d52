#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: moved_away.sh SOURCE BUILD: installs into an empty prefix, takes the source tree out of the program's reach, and runs
# the commands of the demo and a package from another folder. Out of reach: every mention of the source tree in the installed
# program is overwritten by a path of equal length that is not there, so that whatever it opened by it would be missing. The
# tree's own name stays where it has a parent: a linker stores a string that another one ends with only once, so that in a tree
# of that name "full" may be the end of its path.
set -eu
source=$1
build=$2
scratch=$(mktemp -d) && trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix
fail() { echo "moved_away: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$prefix" >/dev/null
# Nothing of what is installed lies in the source tree.
[ -z "$(find "$prefix" -type l)" ] || fail "links were installed"
program=$prefix/bin/photonloom
parent=${source%/*}
end=/${source##*/}
[ -n "$parent" ] || { parent=$source; end=; }
nowhere=/$(printf '%*s' $((${#parent} - 1)) '' | tr ' ' x)$end
[ ! -e "$nowhere" ] || fail "$nowhere is there, expected a path that is not"
export LC_ALL=C
grep -qaF -- "$source" "$program" || fail "the program does not name $source; the check that follows would show nothing"
escaped=$(printf '%s' "$source" | sed 's/[][\.*^$|]/\\&/g')
sed -i "s|$escaped|$nowhere|g" "$program"
! grep -qaF -- "$source" "$program" || fail "the program still names $source"

mkdir "$scratch/elsewhere" "$scratch/cache" "$scratch/home"
cd "$scratch/elsewhere"
unset PHOTONLOOM_RTL
export HOME=$scratch/home XDG_CACHE_HOME=$scratch/cache
# The models that command.cosim built of the same RTL; their key holds no path.
mkdir -p "$build/cosim"
ln -s "$build/cosim" "$scratch/cache/photonloom"
share=$("$program" --data-dir)
[ "$share" = "$prefix/share/photonloom" ] || fail "data files are taken from $share"
# Not without its data: this program has no other place to look.
mv "$share" "$share.aside"
"$program" --data-dir >/dev/null 2>err.txt && fail "it found data files although none are there"
grep -qF "data files are not there: expected the folder rtl in $share (installed)" err.txt || fail "it said: $(cat err.txt)"
mv "$share.aside" "$share"

scene=$share/scenes/cornell_balls.xml
frame="--size 8x8 --spp 1 --gather-rays 6 --k 8 --photons 2000 --caustic-photons 800 --set gatherer.cache_bytes=2048"
"$program" render "$scene" $frame -o golden.exr >/dev/null
"$program" render "$scene" --integrator path --size 8x8 --spp 4 -o path.exr >/dev/null
"$program" compare golden.exr path.exr --error-map error.png >/dev/null
"$program" plan "$scene" $frame -o plan.toml >/dev/null
"$program" cosim "$scene" $frame >cosim.txt || fail "cosim: $(cat cosim.txt)"
"$program" compare golden.exr cosim/cornell_balls/rtl.exr --identical >/dev/null
[ ! -e build ] || fail "the installed program made a folder build"
for more in "" "--board ulx3s-85f"; do
  rm -rf hw
  "$program" generate plan.toml -o hw $more >/dev/null
  "$program" generate --check hw >/dev/null
  "$PHOTONLOOM" generate plan.toml -o hw-of-build $more >/dev/null
  diff -r hw hw-of-build || fail "the installed program's package is not the built one's"
  ! grep -rqF -e "$prefix" -e "$source" hw || fail "a package names a folder of this machine"
done

# Every command of --help has its place in the manual page and each completion, and bash completes it.
commands=$("$program" --help | sed -n '/^Subcommands/,/^$/s/^  \([a-z]*\) .*/\1/p')
[ -n "$commands" ] || fail "--help lists no command"
. "$prefix/share/bash-completion/completions/photonloom"
complete_line() {  # into COMPREPLY
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  _photonloom || true
}
completed() { [[ " ${COMPREPLY[*]} " == *" $1 "* ]]; }
manual=$(<"$prefix/share/man/man1/photonloom.1")
zsh=$(<"$prefix/share/zsh/site-functions/_photonloom")
fish=$(<"$prefix/share/fish/vendor_completions.d/photonloom.fish")
newline=$'\n'
for command in $commands; do
  [[ $newline$manual$newline == *"$newline.SS $command$newline"* ]] || fail "the manual page has no $command"
  [[ $newline$zsh == *"${newline}_photonloom_$command() {"* ]] || fail "zsh has no $command"
  [[ $fish == *" -a $command -d"* ]] || fail "fish has no $command"
  complete_line photonloom "${command%?}"
  completed "$command" || fail "bash does not complete $command"
  for option in $("$program" "$command" --help | sed -n 's/^  \(-[A-Za-z],\)*\(--[a-z-]*\).*/\2/p'); do
    complete_line photonloom "$command" "$option"
    completed "$option" || fail "bash has no $command $option"
    [[ $manual == *"${option//-/\\-}"* ]] || fail "the manual page has no $option"
  done
done
complete_line photonloom render --integrator ''
[ "${COMPREPLY[*]}" = "photonmap path bdpt" ] || fail "bash offers no values of --integrator"
complete_line photonloom board re
[ "${COMPREPLY[*]}" = replay ] || fail "bash does not complete board replay"
! command -v zsh >/dev/null || zsh -n "$prefix/share/zsh/site-functions/_photonloom"
! command -v fish >/dev/null || fish -n "$prefix/share/fish/vendor_completions.d/photonloom.fish"
echo "moved_away: as from the source tree"
