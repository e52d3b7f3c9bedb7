#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs tests where GStreamer has no x264, which is optional: FFV1, ProRes and VP8 work, and H.264 is refused with the
# package that has it. usage: without_x264.sh OUTPUT_TEST CAPTURE_TEST
set -eu
plugins=$(mktemp -d)
trap 'rm -rf "$plugins"' EXIT
for plugin in "$(pkg-config --variable=pluginsdir gstreamer-1.0)"/*.so; do
  case $plugin in *x264*) ;; *) ln -s "$plugin" "$plugins/" ;; esac
done
export GST_PLUGIN_SYSTEM_PATH_1_0="$plugins" GST_REGISTRY_1_0="$plugins/registry"
said=$("$1" --gtest_filter=StreamSinkTest.AReceiverThatIsNotThereOrTakesNothingCostsPicturesAlone 2>&1) && exit 1
case $said in *'GStreamer has no x264enc: install gstreamer1.0-plugins-ugly'*) ;; *) echo "$said"; exit 1 ;; esac
"$1" --gtest_brief=1 --gtest_filter='StreamSinkTest.AFileKeepsColourAlphaAndDepthExactly:StreamSinkTest.AProRes*:StreamSinkTest.AFileThat*:PageWebrtc.*'
"$2" --gtest_brief=1 --gtest_filter='Formats/*Take*'
