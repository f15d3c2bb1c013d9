#!/usr/bin/env bash
# A small study on two cores: killed in the middle and resumed, then once more with nothing to do.
# Usage: bash studies/test.sh PYTHON, a Python with the packages of requirements.txt; the program must be built.
set -euo pipefail
cd "$(dirname "$0")"
python=${1:?a Python with the packages of requirements.txt}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

study() {
    "$python" -m snakemake -s tolerance/Snakefile --cores 2 --directory "$out/work" --rerun-incomplete --quiet all \
        --config rotors=12 batch=2 results="$out/results" case="$PWD/../cases/jeffcott.json" rotor="$PWD/../target/release/rotor" \
        perturb='[{"path": "materials.light.E", "value": 2.1e11, "sd": 0.02}]' "$@"
}
finished() { find "$out/results/batches" -name '*.json' 2>/dev/null | wc -l; }

mkdir -p "$out/work" "$out/results/batches"
setsid bash -c "$(declare -f study); out='$out' python='$python'; study" >/dev/null 2>&1 &
leader=$!
for _ in $(seq 600); do
    [ "$(finished)" -ge 2 ] && break
    sleep 0.1
done
# what has just been written may not be in the workflow's own books yet: only these batches must stay
early=$(cd "$out/results/batches" && ls ./*.json)
sleep 1
kill -9 -- "-$leader" 2>/dev/null || true
wait "$leader" 2>/dev/null || true
before=$(finished)
if [ "$before" -lt 2 ] || [ -e "$out/results/distribution.json" ]; then
    echo "the study was not killed in the middle: $before batches" >&2
    exit 1
fi
(cd "$out/results/batches" && sha256sum $early) >"$out/before"
stamp=$(cd "$out/results/batches" && stat -c '%n %Y' $(sed 's/.*\.\///' "$out/before"))

"$python" -m snakemake -s tolerance/Snakefile --directory "$out/work" --unlock --quiet all >/dev/null 2>&1 || true
study
[ "$stamp" = "$(cd "$out/results/batches" && stat -c '%n %Y' $(sed 's/.*\.\///' "$out/before"))" ] ||
    { echo "finished batches were run again" >&2; exit 1; }
(cd "$out/results/batches" && sha256sum --quiet -c "$out/before")
"$python" - "$out/results/distribution.json" <<'PYTHON'
import json, sys
found = json.load(open(sys.argv[1]))
assert found["rotors"] == 12 and not found["failed"], found
for c in found["critical_speeds"]:
    # frequencies go with the root of E: half its deviation of 2 %, cut off at three
    spread = c["standard_deviation_rpm"] / c["nominal_rpm"]
    assert 0.003 < spread < 0.03, c
PYTHON
grep -q "<svg" "$out/results/distribution.svg"
cp "$out/results/distribution.svg" "$out/first.svg"
study -F 2>/dev/null
cmp "$out/first.svg" "$out/results/distribution.svg"
echo "study: $before of 6 batches kept over a kill, the rest resumed; the same bytes when made anew"
