#!/usr/bin/env bash
# Makes every kept report in this folder anew from cases/. A changed report is committed with its reason.
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo build --release
program="${CARGO_TARGET_DIR:-target}/release/rotor"
baselines=tests/baselines
run() { # analysis case
    "$program" "$1" "$2" --quiet --out "$baselines/$(basename "$2" .json)"
}
for case in cases/*.json; do
    # of scenes in contact the equilibria are kept; a motion repeats to what impacts make of rounding errors
    if grep -q '"contact": {' "$case"; then
        if ! grep -q '"until"' "$case"; then
            run contact "$case"
            rm -f "$baselines/$(basename "$case" .json)/contact-cost.svg"
        fi
        continue
    fi
    run check "$case"
    run modes "$case"
    if grep -q '"campbell": {' "$case"; then
        run campbell "$case"
    fi
    for block in unbalance harmonic map; do
        if grep -q "^  \"$block\": {" "$case"; then
            run "$block" "$case"
        fi
    done
    if grep -q '"loads"' "$case"; then
        run static "$case"
    fi
    # a run through a resonance repeats to the integrator's tolerance only: those with disks are not kept, but for the
    # rub that a ring makes steady
    if grep -q '"spinup": {' "$case" && { ! grep -q '"disks"' "$case" || [ "$case" = cases/rub-ring.json ]; }; then
        run spinup "$case"
    fi
done
rm -f "$baselines"/*/*.cost.json
