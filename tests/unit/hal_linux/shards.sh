#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: shards.sh PROGRAM COUNT: runs the tests of a gtest program in COUNT parts in parallel, each
# in its own network namespace: they wait for the network, not for the processor. Fails if a part
# fails.
set -u
pids=""
shard=0
while [ "$shard" -lt "$2" ]; do
  GTEST_TOTAL_SHARDS=$2 GTEST_SHARD_INDEX=$shard unshare --net --map-root-user \
    sh -c "ip link set lo up && exec \"$1\"" &
  pids="$pids $!"
  shard=$((shard + 1))
done
failed=0
for pid in $pids; do wait "$pid" || failed=1; done
exit $failed
