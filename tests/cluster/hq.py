"""A stand-in for the command `hq` on top of HyperQueue's Python package, which has server and workers and no command.

    hq server                 a server in $HQ_SERVER_DIR, until it is killed
    hq worker FOLDER          a worker of that server, of one CPU, until it is killed; FOLDER is for its own files
    hq submit OPTIONS -- COMMAND
    hq wait JOB               until all tasks have ended; status 1 if one failed
"""

import argparse
import os
import shutil
import signal
import sys
from pathlib import Path

from hyperqueue import Client, Job
from hyperqueue.cluster import LocalCluster, WorkerConfig
from hyperqueue.ffi.protocol import ResourceRequest

FOLDER = Path(os.environ["HQ_SERVER_DIR"])
ACCESS = Path("hq-current") / "access.json"


def server():
    cluster = LocalCluster(str(FOLDER))
    signal.pause()
    del cluster


def worker(folder):
    """The package has workers in their server's process alone. So this is a server of its own, without tasks, whose worker finds the
    other server's address where its own should be."""
    folder = Path(folder).absolute()
    folder.mkdir()
    cluster = LocalCluster(str(folder))
    shutil.copy(FOLDER / ACCESS, folder / ACCESS)
    cluster.start_worker(WorkerConfig(cores=1))
    print("started", flush=True)
    signal.pause()


def submit(words):
    parser = argparse.ArgumentParser(prog="hq submit", allow_abbrev=False)
    parser.add_argument("--name")
    parser.add_argument("--array", required=True)
    parser.add_argument("--cpus", required=True)
    parser.add_argument("--stdout", required=True)
    parser.add_argument("--stderr", required=True)
    at = words.index("--")
    options, command = parser.parse_args(words[:at]), words[at + 1 :]
    first, last = map(int, options.array.split("-"))
    assert first == 0, "the package numbers tasks from 0"
    # As the command has it: all tasks are done, whichever fail.
    job = Job(name=options.name, default_workdir=os.getcwd(), max_fails=None)
    for _ in range(last + 1):
        resources = ResourceRequest(cpus=options.cpus)
        job.program(command, stdout=options.stdout, stderr=options.stderr, resources=resources)
    print(f"Job submitted successfully, job ID: {Client(FOLDER).submit(job).id}")


def wait(job):
    failed = Client(FOLDER).connection.wait_for_jobs([int(job)], lambda _: None)
    sys.exit(1 if failed else 0)


verb, *rest = sys.argv[1:]
if verb == "submit":
    submit(rest)
else:
    {"server": server, "worker": worker, "wait": wait}[verb](*rest)
