#!/bin/sh
# Tests denoising with the real Intel Open Image Denoise, and measures what it gains: FLIP against
# 4096 samples, of 16 samples before and after. Fails if fewer than five scenes are halved.
#
#     scripts/try-denoise.sh           # tests, then measures
#     scripts/try-denoise.sh measure   # measures alone
#
# The library is the one of OIDN_DIR, or of the Python package pyoidn, which is installed into
# target/denoise. SIZE (320x240), REFERENCE (4096 samples) and SCENES ("sky smallpt") make it faster.
# Pictures stay in target/denoise.
set -eu
cd "$(dirname "$0")/.."
work=target/denoise
mkdir -p "$work"
if [ -z "${OIDN_DIR:-}" ]; then
    python3 -m pip install --quiet --upgrade --no-deps --target "$work/python" pyoidn
    OIDN_DIR=$PWD/$work/python/pyoidn/oidn
fi
export OIDN_DIR

if [ "${1:-}" != measure ]; then
    cargo test --release --test cli -- denoise
    cargo test --release --test pictures -- denoising
fi
photosphere=${PHOTOSPHERE:-target/release/photosphere}
[ -n "${PHOTOSPHERE:-}" ] || cargo build --release --quiet
"$photosphere" doctor | grep '^oidn'

size=${SIZE:-320x240}
reference=${REFERENCE:-4096}
flip() {
    "$photosphere" compare "$1" "$2" --layer beauty --metric flip --json |
        python3 -c 'import json, sys; print(json.load(sys.stdin)["layers"][0]["flip"])'
}
echo "FLIP against $reference samples, $size pixels, through the tone curve srgb"
printf '%-28s %10s %10s %8s\n' scene '16 samples' denoised ratio
results=$work/results.txt
: > "$results"
# The scene, and options of the noisy render. The mean of `paper` is that of `path`.
options_of() {
    case $1 in
        paper/fig*) echo "--integrator paper" ;;
    esac
}
noisy="paper/fig2 paper/fig3 paper/fig4 cornell-spheres smallpt"
others="materials many-lights still-life sky bench/small-lamp"
for scene in ${SCENES:-$noisy $others}; do
    name=$work/$(basename "$scene")
    if [ ! -e "$name-truth.exr" ]; then
        "$photosphere" render "scenes/$scene.toml" --size "$size" --spp "$reference" --seed 99 \
            --quiet -o "$name-truth.exr"
    fi
    # shellcheck disable=SC2046 # The options are words.
    "$photosphere" render "scenes/$scene.toml" $(options_of "$scene") --size "$size" --spp 16 \
        --denoise --quiet -o "$name.exr" -o "$name-denoised.pfm" -o "$name-denoised.png"
    "$photosphere" convert "$name.exr" -o "$name-16.png" --layer beauty
    before=$(flip "$name.exr" "$name-truth.exr")
    after=$(flip "$name-denoised.pfm" "$name-truth.exr")
    echo "$scene $before $after" >> "$results"
    tail -n 1 "$results" | awk '{ printf "%-28s %10.4f %10.4f %8.2f\n", $1, $2, $3, $3 / $2 }'
done
awk '$3 / $2 <= 0.5 { halved++ } END { print halved + 0, "of", NR, "are halved"; exit halved < 5 }' \
    "$results"
