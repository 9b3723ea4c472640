#!/usr/bin/env python3
"""Renders pictures in shards on the workers of a Dask cluster.

render.py SCHEDULER SHARDS ARGUMENT...    the arguments are those of `strahl render`
"""

import os
import subprocess
import sys

from dask.distributed import Client, as_completed


def draw(shard, shards, arguments, folder):
    """Renders one shard in the folder of the client; after an exception, Dask tries again."""
    command = ["strahl", "render", *arguments, "--shard", f"{shard}/{shards}"]
    command += ["--resume", "--quiet"]
    done = subprocess.run(command, cwd=folder, stderr=subprocess.PIPE, text=True)
    # 75: temporarily impossible to write. Below 0: a signal. Another try does not help with 1 and 2.
    if done.returncode not in (0, 1, 2):
        raise RuntimeError(f"strahl ended with {done.returncode}: {done.stderr}")
    return done.returncode, done.stderr


def main():
    scheduler, shards, *arguments = sys.argv[1:]
    run_of = {"shards": int(shards), "arguments": arguments, "folder": os.getcwd()}
    statuses = []
    with Client(scheduler) as client:
        # Not pure: a second run with the same arguments has to check the files again.
        runs = client.map(draw, range(int(shards)), **run_of, pure=False, retries=5)
        for run, result in as_completed(runs, with_results=True, raise_errors=False):
            if run.status == "error":
                result = 75, f"{run.exception()}\n"
            status, said = result
            sys.stderr.write(said)
            statuses.append(status)
    # Of several statuses, 2 takes precedence over 75, and 75 over 1.
    return next((status for status in (2, 75, 1) if status in statuses), 0)


if __name__ == "__main__":
    sys.exit(main())
