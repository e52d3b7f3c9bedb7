#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Bash completion of mixrig completes commands, options, their words and files.
# usage: check_completion.sh MIXRIG
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1" help-pages "$folder" || exit 1
source "$folder/mixrig.bash"
cd "$folder" && mkdir takes && touch scene.toml "two words.toml"
failed=0
# completes WANTED WORD...: the last word is the one under the cursor.
completes() {
  local wanted=$1
  shift
  COMP_WORDS=(mixrig "$@") COMP_CWORD=$#
  _mixrig
  local got="${COMPREPLY[*]}"
  [[ $got == "$wanted" ]] && return
  echo "mixrig $*: completes \"$got\", not \"$wanted\"" >&2
  failed=1
}
completes "run record rig" r
completes "rig" calibrate r
completes "init" rig i
completes "auto gles cpu" run --backend ""
completes "gles" run --backend = g
completes "--backend --baselines" run --ba
completes "scene.toml" run sc
completes "two words.toml" run --calibration tw
completes "takes" info ta
completes "" run --threads ""
completes "--out" calibrate rig --ou
exit $failed
