#!/bin/sh
# Tests denoising with the real Intel Open Image Denoise, and measures what it gains: FLIP against
# 4096 samples, of 16 samples before and after, on five scenes.
#
#     scripts/try-denoise.sh           # tests, then measures
#     scripts/try-denoise.sh measure   # measures alone
#
# The library is the one of OIDN_DIR, or of the Python package pyoidn, which is installed into
# target/denoise. SIZE (160x120) and REFERENCE (4096 samples) make it faster. Pictures stay in
# target/denoise.
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
cargo build --release --quiet
photosphere=target/release/photosphere
"$photosphere" doctor | grep '^oidn'

size=${SIZE:-160x120}
reference=${REFERENCE:-4096}
flip() {
    "$photosphere" compare "$1" "$2" --layer beauty --metric flip --json |
        python3 -c 'import json, sys; print(json.load(sys.stdin)["layers"][0]["flip"])'
}
echo "FLIP against $reference samples, $size pixels, through the tone curve srgb"
printf '%-28s %10s %10s %8s\n' scene '16 samples' denoised ratio
worst=0
for scene in paper/fig2 cornell-spheres smallpt materials many-lights; do
    name=$work/$(basename "$scene")
    if [ ! -e "$name-truth.exr" ]; then
        "$photosphere" render "scenes/$scene.toml" --size "$size" \
            --spp "$reference" --seed 99 --quiet -o "$name-truth.exr"
    fi
    "$photosphere" render "scenes/$scene.toml" --size "$size" --spp 16 --denoise --quiet \
        -o "$name.exr" -o "$name-denoised.pfm" -o "$name-denoised.png"
    "$photosphere" convert "$name.exr" -o "$name-16.png" --layer beauty
    before=$(flip "$name.exr" "$name-truth.exr")
    after=$(flip "$name-denoised.pfm" "$name-truth.exr")
    echo "$scene $before $after" |
        awk '{ printf "%-28s %10.4f %10.4f %8.2f\n", $1, $2, $3, $3 / $2 }'
    worst=$(echo "$worst $before $after" | awk '{ r = $3 / $2; print r > $1 ? r : $1 }')
done
echo "$worst" | awk '{ print "worst ratio " $1; exit $1 > 0.5 }'
