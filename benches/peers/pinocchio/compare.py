"""Rolls out the same motions with this crate and with Pinocchio, in turns, and prints tables of both."""

import argparse
import json
import math
import random
import statistics
import subprocess
import tomllib
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3] / "src"

BOX = [1.0, 0.35]
"""Half-widths, by term, of the box that the task is searched in."""

ATTITUDE_STEPS = 24
"""Magnus steps of its search."""

MOTIONS = 1000
PASSES = 3
"""Passes through all motions in a turn; the fastest counts."""

TOLERANCE = 1e-12
"""How far apart the entries of the quaternions may be."""

WAYS = {
    "map": "free base: `computeCentroidalMap`, 6×6 LU",
    "crba-local": "free base: `crba`, local, 6×6 Cholesky",
    "crba-world": "free base: `crba`, world, 6×6 Cholesky",
    "ccrba": "free base at rest: `ccrba`, 3×3 inverse",
    "momentum": "free base at rest: `computeCentroidalMomentum`, composite inertia, 3×3 inverse",
    "fixed-ccrba": "fixed base: `ccrba`, base's inertia added, 3×3 inverse",
    "inward": "fixed base: `forwardKinematics`, inward sweep, 3×3 inverse",
    "inward-only": "the same, revolute joints the only kind",
    "inward-unbounded": "the same, all kinds, joints given by cosine and sine",
    "inward-only-unbounded": "the same, revolute joints the only kind, given by cosine and sine",
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ours", type=Path, help="the example `rollout`, built")
    parser.add_argument("folder", type=Path, help="where the programs on Pinocchio are, and files go")
    parser.add_argument("rounds", type=int, nargs="?", default=30)
    arguments = parser.parse_args()
    problem, motions = arguments.folder / "problem.txt", arguments.folder / "motions.txt"
    nodes = write_problem(problem, motions)
    widths = json.loads(subprocess.run([arguments.ours], capture_output=True, check=True).stdout)
    programs = {width: Program(arguments.ours, width, motions) for width in widths}
    for build in ("rollout", "rollout-fast-math"):
        for way in WAYS:
            programs[build, way] = Program(arguments.folder / build, way, problem, motions)
    for _ in range(arguments.rounds):
        for program in programs.values():
            program.take_turn()
    rotations = {name: program.end() for name, program in programs.items()}
    times = {name: program.seconds for name, program in programs.items()}
    print_comparison(times, widths, nodes)
    print_ways(times)
    print_agreement(rotations, widths)


class Program:
    """A running program, which goes through all motions when it is asked to."""

    def __init__(self, *command):
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
        self.seconds = []
        self.take_turn()
        # Whatever a process pays only once is paid by now.
        self.seconds.clear()

    def take_turn(self):
        """Notes the seconds a rollout of the fastest pass."""
        self.seconds.append(min(self.take_pass() for _ in range(PASSES)))

    def take_pass(self):
        """Seconds a rollout."""
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return float(self.process.stdout.readline())

    def end(self):
        """The rotation at the end of every motion."""
        output, _ = self.process.communicate()
        return json.loads(output)


def write_problem(problem, motions):
    """Writes what the programs read, from the crate's own files, and returns the number of nodes.

    `problem`: Magnus steps, terms, joints; the base's body; the mount. Then of each joint DH offset, d,
    a and twist, both ends of its range, both of its path; and its link's body. A body is mass, centre
    of mass, the inertia's xx, yy, zz, xy, xz, yz. Angles are in radians.

    `motions`: how many, then the coefficients of each, joint by joint, drawn from the box.
    """
    files = ("reorientation/defaults.toml", "task/shipped/xiao2023.toml", "robot/shipped/xiao2023.toml")
    defaults, table, robot = (tomllib.loads((SOURCE / name).read_text()) for name in files)
    task, trajectory = table["task"], defaults["trajectory"]
    base, joints = robot["base"], robot["joint"]
    steps, terms = ATTITUDE_STEPS, trajectory["terms"]
    rows = [[steps, terms, len(joints)], body(base, [0, 0, 0]), base["mount"]]
    ends = zip(task["start"]["joints_deg"], task["goal"]["joints_deg"], strict=True)
    for joint, path in zip(joints, ends, strict=True):
        dh = joint["dh"]
        offset, twist = math.radians(dh["offset_deg"]), math.radians(dh["alpha_deg"])
        rows.append([offset, dh["d"], dh["a"], twist])
        rows.append(map(math.radians, (*joint["range_deg"], *path)))
        rows.append(body(joint, joint["centre_of_mass"]))
    write(problem, rows)
    rng = random.Random(1)
    box = BOX[:terms] * len(joints)
    rows = [[rng.uniform(-width, width) for width in box] for _ in range(MOTIONS)]
    write(motions, [[MOTIONS], *rows])
    # Panels of three steps and six nodes.
    return 6 * math.ceil(steps / 3)


def body(table, centre):
    """Mass, centre of mass and inertia of one body of a robot file."""
    entries = [table["inertia"].get(key, 0) for key in ("xx", "yy", "zz", "xy", "xz", "yz")]
    return [table["mass"], *centre, *entries]


def write(path, rows):
    """Rows of numbers, with all their digits."""
    path.write_text("".join(" ".join(map(repr, row)) + "\n" for row in rows))


def print_comparison(times, widths, nodes):
    """This crate beside the fastest way on Pinocchio, as a Markdown table."""
    def fastest(build):
        names = [(build, way) for way in WAYS]
        return min(names, key=lambda name: statistics.median(times[name]))

    widest, scalar = widths[-1], widths[0]
    rows = {f"this crate, {width}": width for width in reversed(widths)}
    rows["Pinocchio, fast math"] = fastest("rollout-fast-math")
    rows["Pinocchio, strict"] = fastest("rollout")
    print_row("", "µs a rollout", "µs a node", f"in those of {widest}", f"in those of {scalar}")
    print_row(*["---"] * 5)
    for label, name in rows.items():
        micro = 1e6 * statistics.median(times[name])
        ratios = [f"{ratio(times[name], times[other]):.2f}" for other in (widest, scalar)]
        print_row(label, f"{micro:.2f}", f"{micro / nodes:.3f}", *ratios)


def print_ways(times):
    """All ways on Pinocchio, as a Markdown table."""
    print()
    print_row("way to the base's rate", "µs a rollout, strict", "fast math")
    print_row(*["---"] * 3)
    for way, label in WAYS.items():
        micros = [1e6 * statistics.median(times[b, way]) for b in ("rollout", "rollout-fast-math")]
        print_row(label, *(f"{micro:.2f}" for micro in micros))


def ratio(times, others):
    """Median over the rounds, in each of which both had their turns within a few seconds."""
    return statistics.median(a / b for a, b in zip(times, others, strict=True))


def print_row(*cells):
    """One row of a Markdown table."""
    print("|", " | ".join(cells), "|")


def print_agreement(rotations, widths):
    """How far apart the rotations are that all find."""
    ours = rotations[widths[-1]]
    apart = {
        name: max(abs(a - b) for p, q in zip(theirs, ours, strict=True) for a, b in zip(p, q))
        for name, theirs in rotations.items()
    }
    worst = max(value for name, value in apart.items() if name not in widths)
    print(f"\nquaternions of all ways on Pinocchio and of {widths[-1]}: {worst:.1e} apart at most,")
    print(f"those of this crate's widths: {max(apart[width] for width in widths):.1e}")
    if not max(apart.values()) <= TOLERANCE:
        raise SystemExit(f"more than {TOLERANCE}: {apart}")


if __name__ == "__main__":
    main()
