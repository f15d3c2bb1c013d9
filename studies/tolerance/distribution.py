"""From batches to the distribution of critical speeds: python distribution.py JSON SVG BATCH..., configuration on
standard input."""

import json
import statistics
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "rotor"
import matplotlib.pyplot as plt


def quantile(ordered, share):
    """Linear between the two nearest of an ordered list."""
    at = share * (len(ordered) - 1)
    low = int(at)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (at - low) * (ordered[high] - ordered[low])


def summary(branch, nominal, speeds):
    ordered = sorted(speeds)
    return {
        "branch": branch,
        "nominal_rpm": nominal,
        "rotors": len(ordered),
        "mean_rpm": statistics.fmean(ordered),
        "standard_deviation_rpm": statistics.stdev(ordered) if len(ordered) > 1 else 0.0,
        "quantiles_rpm": {str(share): quantile(ordered, share) for share in (0.0, 0.05, 0.5, 0.95, 1.0)},
    }


def draw(path, by_branch, summaries, avoid):
    rows = len(by_branch)
    figure, axes = plt.subplots(rows, 1, figsize=(7, 1.1 + 1.7 * rows), layout="constrained", squeeze=False)
    band = [avoid["speed_rpm"] * (1 + sign * avoid["margin"]) for sign in (-1, 1)]
    handles = {}
    for axis, (branch, speeds), s in zip(axes[:, 0], by_branch.items(), summaries):
        axis.hist(speeds, bins="auto", color="0.8", edgecolor="0.3", linewidth=0.6)
        handles["nominal"] = axis.axvline(s["nominal_rpm"], color="black")
        for share in ("0.05", "0.95"):
            handles["5 % and 95 %"] = axis.axvline(s["quantiles_rpm"][share], color="black", linestyle="--", linewidth=1)
        left, right = axis.get_xlim()
        if left < band[1] and band[0] < right:
            label = f"within {100 * avoid['margin']:g} % of {avoid['speed_rpm']:g} rpm"
            handles[label] = axis.axvspan(
                max(left, band[0]), min(right, band[1]), facecolor="none", edgecolor="0.5", hatch="///", linewidth=0
            )
            axis.set_xlim(left, right)
        axis.set_ylabel("rotors")
        deviation = f"mean {s['mean_rpm']:.0f} rpm, standard deviation {s['standard_deviation_rpm']:.0f} rpm"
        axis.set_title(f"{branch}: {deviation}", fontsize=9)
    axes[-1, 0].set_xlabel("critical speed (rpm)")
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=len(handles), fontsize=8)
    figure.savefig(path, metadata={"Date": None})


def main():
    output, svg, batches = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
    config = json.load(sys.stdin)
    rotors = sorted((r for b in batches for r in json.loads(Path(b).read_text())), key=lambda r: r["number"])
    if len(rotors) != config["rotors"]:
        sys.exit(f"{len(rotors)} rotors instead of {config['rotors']}: batches of another study? remove them")
    failed = [r for r in rotors if "failed" in r]
    done = [r for r in rotors if "failed" not in r]
    if not done or done[0]["number"] != 0:
        sys.exit(f"the nominal rotor failed: {failed[0]['failed']}")
    nominal = {c["branch"]: c["speed_rpm"] for c in done[0]["critical_speeds"]}
    by_branch = {
        branch: [c["speed_rpm"] for r in done for c in r["critical_speeds"] if c["branch"] == branch]
        for branch in nominal
    }
    summaries = [summary(branch, nominal[branch], speeds) for branch, speeds in by_branch.items()]
    avoid = config["avoid"]
    near = lambda c: abs(c["speed_rpm"] / avoid["speed_rpm"] - 1) <= avoid["margin"]
    share = sum(any(near(c) for c in r["critical_speeds"]) for r in done) / len(done)
    result = {
        "rotors": len(rotors),
        "failed": [{"number": r["number"], "reason": r["failed"]} for r in failed],
        "critical_speeds": summaries,
        "avoid": avoid | {"share_of_rotors": share},
    }
    output.write_text(json.dumps(result, indent=1) + "\n")
    draw(svg, by_branch, summaries, avoid)


main()
