"""Plans tasks freely and with limits on clearance, and prints a table in Markdown.

    python clearances.py PROGRAM [TASK.toml ...]

Without tasks it takes those of all robots that come with the program. Lengths are in metres.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

LIMITS = (0.02, 0.05)
SHIPPED = pathlib.Path(__file__).resolve().parents[2] / "src" / "task" / "shipped"


def with_clearance(text, clearance):
    """The task's text with a limit on clearance."""
    header = "[task.limits]"
    if header not in text:
        text += f"\n{header}\n"
    return text.replace(header, f"{header}\nclearance_m = {clearance}", 1)


def plan(program, task):
    """What the program says of a task: its object, or its error."""
    run = subprocess.run([program, "plan", str(task), "--json"], capture_output=True, text=True)
    if run.returncode or not run.stdout:
        return {"error": run.stderr.strip()}
    return json.loads(run.stdout)


def cells(found):
    """Duration, least clearance and seconds of work."""
    if "error" in found:
        # The sentence above the excerpt of the file, wrapped to the width of a terminal.
        message = found["error"].partition("╭")[0]
        return ["–", " ".join(message.replace("×", " ").replace("│", " ").split()), "–"]
    duration = f"{found['t_f']:.3f}"
    if not (found["reached"] and found["within_limits"]):
        duration += f" ({found['status']}, {found['residual_deg']:.1g}°)"
    return [duration, f"{found['clearance_m']:.4f}", f"{found['seconds']:.1f}"]


def main():
    program, *files = sys.argv[1:]
    files = [pathlib.Path(file) for file in files] or sorted(SHIPPED.glob("*.toml"))
    limits = [None, *LIMITS]
    heads = [f"{what}, {'free' if limit is None else f'{limit} m'}"
             for limit in limits for what in ("t_f [s]", "least clearance [m]", "work [s]")]
    print("| " + " | ".join(["task", *heads]) + " |")
    print("|" + "---|" * (1 + len(heads)))
    for file in files:
        text = file.read_text()
        row = [f"`{file.stem}`"]
        with tempfile.TemporaryDirectory() as folder:
            task = pathlib.Path(folder) / file.name
            robot = file.parent / tomllib.loads(text)["task"]["robot"]
            if robot.is_file():
                (task.parent / robot.name).write_bytes(robot.read_bytes())
            for limit in limits:
                task.write_text(text if limit is None else with_clearance(text, limit))
                found = plan(program, task)
                print(json.dumps({"task": file.stem, "limit": limit} | {
                    key: found.get(key) for key in
                    ("error", "status", "reached", "within_limits", "t_f", "residual_deg", "clearance_m",
                     "clearance_between", "limits_used", "shapes", "seconds")}), file=sys.stderr, flush=True)
                row += cells(found)
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
