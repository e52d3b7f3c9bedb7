#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: own_network.sh PROGRAM [ARGUMENT ...]: runs it in a network namespace with two loopback
# addresses, one for each emulated GigE Vision camera: their discovery broadcasts.
exec unshare --net --map-root-user \
  sh -c 'ip link set lo up && ip addr add 127.0.0.2/8 dev lo && exec "$@"' sh "$@"
