#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The last step of ./demo on a small take: the page names files that exist and has every figure.
# usage: demo_page_test.sh MIXRIG REPOSITORY
set -euo pipefail
mixrig=$1 page=$2/scripts/demo_page
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir 'a b'  # what needs to be written in another way in an address
take='a b/take & 1' out='a b/out'
fail() { echo "demo_page_test: $*" >&2; exit 1; }
# Without video, and without sheet and report, there is no page.
refused() { ! "$page" "$out" "$take" 2>why && [[ $(wc -l <why) == 1 ]] && grep -q 'there is no' why && [[ ! -e $out/index.html ]]; }

"$mixrig" studio "$take" --plain --scenario walk --frames 8 --size 320x256 >/dev/null
mkdir "$out"
refused || fail "a page of nothing"
"$mixrig" run "$take/scene.toml" --source "take:$take" --out "$out" --format none --stream demo.mp4 --backend cpu >/dev/null
refused || fail "a page without its video"
mv demo.mp4 "$out"
"$page" "$out" "$take"

cd "$out"
named=0
while IFS= read -r address; do
  file=$(sed 's/&amp;/\&/g; s/%20/ /g; s/%25/%/g' <<<"$address")
  [[ -s $file ]] || fail "index.html names $address, which is not there"
  named=$((named + 1))
done < <(grep -oE '(src|href)="[^"]*"' index.html | sed 's/^[a-z]*="//; s/"$//')
((named >= 7)) || fail "only $named files are named"
first=$(grep -oE 'first = [0-9]+' index.html | grep -oE '[0-9]+')
[[ $first == 5 ]] || fail "the first composited frame is 5, not '$first'"
[[ -s ../take\ \&\ 1/color/00000$first.png ]] || fail "no picture of the camera for frame $first"
figures=$(grep -cE '<dt>[0-9.]+( %| dB| MB)?</dt>' index.html)
[[ $figures == 6 ]] || fail "$figures of 6 figures are there: $(grep '<dt>' index.html)"
grep -q '<title>mixrig: walk 1, kinect2</title>' index.html || fail "the title does not name the take"
! grep -qE 'https?://' index.html || fail "the page needs the network"
