# SPDX-License-Identifier: Apache-2.0
# In the guest: modules and udev, then the tests that /host/tests names.
cp -r /host/bin /tmp/bin; export PATH=/tmp/bin:$PATH  # the share is slow to run programs from
[ ! -f /host/environment ] || . /host/environment
export GTEST_COLOR=no
if [ -d /run/systemd/system ]; then  # the services are tested, which have no devices of their own
  cd /tmp && . /host/tests
  exit
fi
for module in vhci-hcd uvcvideo cdc-acm xhci-pci ftdi_sio configfs; do
  modprobe $module || { echo "board: no module $module"; exit 1; }
done
modprobe vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=0 || exit 1
mount -t configfs none /sys/kernel/config || exit 1
insmod /host/modules/irq_sim.ko && insmod /host/modules/gpio-sim.ko || exit 1
sysctl -qp /host/70-mixrig.conf
echo 64 >/sys/module/usbcore/parameters/usbfs_memory_mb  # as docs/reference/devices.md asks
# libusb gets its hotplug events from it.
/lib/systemd/systemd-udevd --daemon 2>/dev/null
[ ! -S /host/screen.sock ] || { modprobe -a virtio_gpu virtio_input evdev && udevadm trigger; }
udevadm settle
# Reads every file that a test will need now: where the guest's idle time is skipped, its clock runs
# ahead while it waits for the share.
for warm in 'board_tests --gtest_list_tests' 'mixrig diag --no-move --watch 0.5' 'mixrig --help' \
  'dfu-util -l' 'v4l2-ctl -d /dev/video0 -l' 'sh -c true'; do
  $warm >/dev/null 2>&1
done
udevadm settle
[ ! -c /dev/ttyS0 ] || [ ! -e /host/ptu.sock ] || export MIXRIG_BOARD_PTU=/dev/ttyS0
[ ! -c /dev/ttyUSB0 ] || export MIXRIG_BOARD_MCU=/dev/ttyUSB0
echo "board: ready after $(cut -d' ' -f1 /proc/uptime) s"
cd /tmp && . /host/tests
