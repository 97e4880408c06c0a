#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A sweep on Slurm and MPI has the same rows, byte for byte, as on this machine: a cluster of one node (slurmctld and
slurmd on loopback, without authentication) and ranks of mpirun.

engines_test.py SLEWRING SCENE SUPPORT
"""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

sys.path.insert(0, sys.argv[3])
from waiting import require, skip, text_of, wait_for  # noqa: E402

SLURM_PROGRAMS = ["slurmctld", "slurmd", "sbatch", "scancel", "squeue", "sinfo"]
CONFIGURATION = """
ClusterName=sweep
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={control_port}
SlurmdPort={node_port}
AuthType=auth/none
CredType=cred/none
SlurmUser={user}
SlurmdUser={user}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    """slurmctld and slurmd of one node."""

    def __init__(self, folder):
        self.log = open(os.path.join(folder, "slurm.log"), "w", encoding="utf-8")
        for name in ["state", "spool"]:
            os.mkdir(os.path.join(folder, name))
        file = os.path.join(folder, "slurm.conf")
        with open(file, "w", encoding="utf-8") as out:
            out.write(CONFIGURATION.format(host=socket.gethostname().split(".")[0], control_port=free_port(),
                                           node_port=free_port(), user=getpass.getuser(), folder=folder))
        self.environment = {**os.environ, "SLURM_CONF": file}
        self.daemons = [subprocess.Popen([shutil.which(name), "-c", "-D"], env=self.environment, stdout=self.log,
                                         stderr=subprocess.STDOUT) for name in ["slurmctld", "slurmd"]]

    def output(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False).stdout

    def wait(self):
        wait_for("an idle node of Slurm", lambda: "idle" in self.output("sinfo", "-h", "-o", "%T"))

    def end(self):
        for daemon in self.daemons:
            daemon.send_signal(signal.SIGTERM)
        for daemon in self.daemons:
            daemon.wait(timeout=30)
        self.log.close()


def rows_of(folder):
    rows = os.path.join(folder, "rows")
    return {name: text_of(os.path.join(rows, name)) for name in os.listdir(rows)
            if name.endswith(".json") and name not in ["job.json", "batch.json"]}


def main():
    slewring, scene = sys.argv[1:3]
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    missing = [name for name in SLURM_PROGRAMS + ["mpirun"] if shutil.which(name) is None]
    if missing:
        skip("not installed: " + ", ".join(missing))
    work = tempfile.mkdtemp()

    def arguments(engine, folder, rows=5, until="0.2s"):
        return [slewring, "sweep", scene, "--until", until, "--vary", f"Cyl_Lift.seal_friction=0.5kN..3kN:{rows}",
                "--measure", "max(Cyl_Lift.force)", "--engine", engine, "--workers", "2", "--quiet", "-o",
                os.path.join(work, folder)]

    def sweep(engine, folder, environment):
        result = subprocess.run(arguments(engine, folder), cwd=work, env=environment, capture_output=True, text=True,
                                check=False)
        require(result.returncode == 0, f"{engine} ended with {result.returncode}: {result.stderr}")
        return rows_of(os.path.join(work, folder))

    # mpirun refuses root, and more ranks than processors, unless it is allowed
    ranks = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
             "OMPI_MCA_rmaps_base_oversubscribe": "1"}
    local = sweep("local", "local", os.environ)
    require(len(local) == 5, f"{len(local)} rows")
    require(sweep("mpi", "mpi", ranks) == local, "the rows of MPI differ from those of this machine")

    cluster = Cluster(work)
    try:
        cluster.wait()
        require(sweep("slurm", "slurm", cluster.environment) == local, "the rows of Slurm differ")
        # an interrupt cancels the job and keeps what is done
        process = subprocess.Popen(arguments("slurm", "ended", 500, "2s"), env=cluster.environment,
                                   stdout=subprocess.PIPE, text=True)
        wait_for("a row of Slurm", lambda: os.path.exists(os.path.join(work, "ended", "rows", "000001.json")))
        process.send_signal(signal.SIGINT)
        out = process.communicate(timeout=60)[0]
        require(process.returncode == 130, f"an interrupted sweep ended with {process.returncode}")
        require("the same command continues" in out, out)
        wait_for("the end of the job", lambda: not cluster.output("squeue", "-h").strip())
    finally:
        cluster.end()
    shutil.rmtree(work)


main()
