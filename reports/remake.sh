#!/usr/bin/env bash
# Makes every baseline in this folder anew from cases/. A changed baseline is committed with its reason.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release
for case in cases/*.json; do
    # of scenes in contact the equilibria are kept; a motion repeats to what impacts make of rounding errors
    if grep -q '"contact": {' "$case"; then
        if ! grep -q '"until"' "$case"; then
            target/release/rotor contact "$case" --quiet
            rm -f "reports/$(basename "$case" .json)/contact-cost.svg"
        fi
        continue
    fi
    target/release/rotor check "$case" --quiet
    target/release/rotor modes "$case" --quiet
    if grep -q '"campbell": {' "$case"; then
        target/release/rotor campbell "$case" --quiet
    fi
    if grep -q '"loads"' "$case"; then
        target/release/rotor static "$case" --quiet
    fi
    # a run through a resonance repeats to the integrator's tolerance only: those with disks are not kept, but for the
    # rub that a ring makes steady
    if grep -q '"spinup": {' "$case" && { ! grep -q '"disks"' "$case" || [ "$case" = cases/rub-ring.json ]; }; then
        target/release/rotor spinup "$case" --quiet
    fi
done
