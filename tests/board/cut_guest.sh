# SPDX-License-Identifier: Apache-2.0
# In the guest: recordings of twenty seconds on a disk, one after the other, until the board is cut off (cut.py).
modprobe virtio_blk && modprobe ext4 && mkdir -p /disk && mount /dev/vda /disk || exit 1
cp -r /host/bin /tmp/bin; cp -r /host/take /host/rig.toml /tmp/; export PATH=/tmp/bin:$PATH
mixrig --help >/dev/null || exit 1
while :; do echo "up $(cut -d' ' -f1 /proc/uptime)"; sleep 0.1; done &
number=0
while :; do
  number=$((number + 1))
  echo "begins shot$number"
  mixrig record --rig /tmp/rig.toml /disk/shot$number --duration 20 --keep-free 0 2>&1 | tail -n 2
done
