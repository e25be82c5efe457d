"""Plans tasks of robots that start with angular momentum, and has MuJoCo's forward dynamics play the motions.

The folder that `plan --motion NAME.mujoco` writes has a player that gives the base the planned rate at the start, holds the centre
of mass still and drives the joints alone; the base then ends where MuJoCo's equations of motion bring it. Momentum on the way, and
the torques of the plan, are compared with MuJoCo's.

    python drift.py PROGRAM [TASK.toml ...]
"""
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
LEAST_STEPS, STEPS_PER_SECOND = 4000, 200
TOLERANCE_DEG = 1e-3


def load(path):
    spec = importlib.util.spec_from_file_location("play", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def angular_momentum(model, data):
    """About the centre of mass, inertial axes."""
    mujoco.mj_subtreeVel(model, data)
    return data.subtree_angmom[1].copy()


def check(program, task, folder):
    out = folder / f"{task.stem}.mujoco"
    line = [program, "plan", str(task), "--json", "--motion", str(out)]
    found = json.loads(subprocess.run(line, capture_output=True, text=True, check=True).stdout)
    play = load(out / "play.py")
    model, motion = play.load()
    start = mujoco.MjData(model)
    play.place(model, start, motion.attitude[0], motion.base_position[0], motion.base_rate[0], motion.position[0], motion.rate[0])
    stated = np.array(found["drift"]["angular_momentum"])
    momenta = [angular_momentum(model, start)]
    torque_off = 0.0
    for i in range(0, len(motion.time), 25):
        play.place(model, start, motion.attitude[i], motion.base_position[i], motion.base_rate[i], motion.position[i], motion.rate[i])
        momenta.append(angular_momentum(model, start))
        torque_off = max(torque_off, np.abs(play.torques(model, start, motion.acceleration[i]) - motion.torque[i]).max())
    torque_off /= np.abs(motion.torque).max()
    steps = max(LEAST_STEPS, round(STEPS_PER_SECOND * motion.duration))
    end, _ = play.play(model, motion, steps)
    momenta.append(angular_momentum(model, end))
    apart = play.angle_deg(end.qpos[3:7], motion.attitude[-1])
    off = max(np.linalg.norm(at - stated) for at in momenta) / np.linalg.norm(stated)
    rate = np.linalg.norm(found["drift"]["end_base_rate_deg_s"])
    good = found["reached"] and apart < TOLERANCE_DEG and off < 1e-5 and torque_off < 1e-6
    verdict = "" if good else "  NOT AS PLANNED"
    print(f"{task.stem:20} t_f {found['t_f']:8.3f} s, residual {found['residual_deg']:.1e}°, MuJoCo ends {apart:.1e}° from the plan, "
          f"momentum off by {off:.0e}, torques by {torque_off:.0e}, {rate:.3f} °/s at the end{verdict}", flush=True)
    return good


def main():
    program, *tasks = sys.argv[1:]
    tasks = [pathlib.Path(task) for task in tasks] or sorted((HERE / "drift").glob("*.toml"))
    with tempfile.TemporaryDirectory() as folder:
        good = [check(program, task, pathlib.Path(folder)) for task in tasks]
    return not all(good)


if __name__ == "__main__":
    raise SystemExit(main())
