# SPDX-License-Identifier: Apache-2.0
# In the guest: the cross-built mixrig on kernel devices. Faults are switched on one at a time.
fail() { echo "FAIL: $*"; exit 1; }
verdict() { sed -n 's/^ *"verdict": "\(.*\)"/\1/p' "$1" | tail -n 1; }
failed_device() { grep -B4 '"verdict": "fail"' "$1" | sed -n 's/.*"device": "\(.*\)",/\1/p' | sort -u | tr '\n' ' '; }

modprobe configfs && mount -t configfs none /sys/kernel/config || fail "no configfs"
modprobe vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0 || fail "no vivid"
trigger=
if insmod /host/modules/irq_sim.ko && insmod /host/modules/gpio-sim.ko; then
  chip=/sys/kernel/config/gpio-sim/board
  mkdir -p $chip/bank0 && echo 8 >$chip/bank0/num_lines && echo 1 >$chip/live
  trigger="[trigger]
uri = \"gpiod:$(cat $chip/bank0/chip_name)/0,1\"
[[trigger.line]]
line = 0
divider = 4
width_ms = 1.0"
fi
cd /tmp
cat >rig.toml <<END
format = 1
name = "virtual board"
$trigger
[[camera]]
name = "color"
uri = "v4l2:/dev/video0"
size_px = [320, 180]
format = "yuyv"
[depth]
uri = "v4l2:/dev/video1"
size_px = [320, 180]
format = "gray16"
[pan_tilt]
uri = "flir-ptu:/dev/ttyS0"
END

echo "--- all devices"
mixrig diag --rig rig.toml --watch 4 --json all.json || fail "diag"
echo "verdict $(verdict all.json)"
[ -z "$(failed_device all.json)" ] || fail "failed: $(failed_device all.json)"

echo "--- record"
mixrig record --rig rig.toml --duration 4 --format png --json record.json take || fail "record"
mixrig info take || fail "the take cannot be read"
grep -E '"(frames|left_out|ended|dropped_sets|incomplete_sets|paired|no_tick)"' record.json
awk -F, 'NR > 1 && $2 == "color" { n++; if (last && $3 <= last) bad++; last = $3 } END { print n, "frames, ticks in order but", bad + 0; exit bad > 0 || n < 10 }' take/ticks.csv || fail "ticks"

echo "--- camera unplugged and back while recording"
(sleep 2; v4l2-ctl -d /dev/video1 -c disconnect=1 2>/dev/null || v4l2-ctl -d /dev/video1 -C disconnect) &
mixrig record --rig rig.toml --duration 4 --format png --json gone.json take2; echo "record ended with $?"
grep -E '"(name|state|returns|frames)"' gone.json
modprobe -r vivid; modprobe vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=0

echo "--- a device that is missing"
mixrig diag --rig rig.toml --watch 2 --json missing.json --no-move
[ "$(failed_device missing.json)" = "depth " ] || fail "wrong verdict: $(failed_device missing.json)"
echo "board: all passed"
