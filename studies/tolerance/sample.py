"""Runs one batch of rotors: python sample.py CASE OUTPUT, what the batch depends on as JSON on standard input.

Rotor 0 is the nominal one. A run that does not succeed (exit code 1) is kept with its reason; bad input ends the batch.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path


def perturbed(config, number):
    """Values by path: normal, cut off at three standard deviations; a rotor depends on seed and number alone."""
    draw = random.Random(f"{config['seed']}/{number}")
    values = {}
    for entry in config["perturb"]:
        deviation = draw.gauss(0.0, 1.0)
        while abs(deviation) > 3.0:
            deviation = draw.gauss(0.0, 1.0)
        factor = 1.0 if number == 0 else 1.0 + float(entry["sd"]) * deviation
        values[entry["path"]] = float(entry["value"]) * factor
    return values


def run(config, case, number, folder):
    """Critical speeds (rpm) of one rotor, or why there are none."""
    values = perturbed(config, number)
    command = [config["rotor"], "campbell", case, "--out", folder, "--quiet", "--no-plots", "--threads", "1"]
    for path, value in values.items():
        command += ["--set", f"{path}={value!r}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 2:
        sys.exit(f"rotor {number}: {done.stderr}")
    rotor = {"number": number, "values": values}
    if done.returncode != 0:
        return rotor | {"failed": done.stderr.strip() or f"exit code {done.returncode}"}
    criticals = json.loads(Path(folder, "campbell.json").read_text())["results"]["critical_speeds"]
    return rotor | {
        "critical_speeds": [{key: c[key] for key in ("speed_rpm", "branch", "whirl", "kind")} for c in criticals]
    }


def main():
    case, output = sys.argv[1], Path(sys.argv[2])
    config = json.load(sys.stdin)
    numbers = range(*config["numbers"])
    with tempfile.TemporaryDirectory() as folder:
        rotors = [run(config, case, number, folder) for number in numbers]
    temporary = output.with_suffix(f".{os.getpid()}.tmp")
    temporary.write_text(json.dumps(rotors, indent=1) + "\n")
    temporary.replace(output)


main()
