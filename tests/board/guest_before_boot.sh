# SPDX-License-Identifier: Apache-2.0
# In the guest, before systemd: the package installed, a rig and a scene in place, the service enabled.
cp -r /host/package/* /
mkdir -p /etc/mixrig /etc/systemd/system/mixrig.service.d
sed 's#"../walk/#"/host/takes/walk/#' /host/takes/still/scene.toml >/etc/mixrig/scene.toml
cp /host/takes/still/rig.toml /etc/mixrig/
printf '[Service]\nWatchdogSec=8\nRestartSec=1\n' >/etc/systemd/system/mixrig.service.d/test.conf
systemctl --root=/ enable mixrig
